# Builds small trees under SCRATCH and says what CHECK must make of them.
cmake_minimum_required(VERSION 3.22)

function(run_check result_status result_output)
    execute_process(
        COMMAND ${CMAKE_COMMAND} -D "PATINA_ROOT=${SCRATCH}" -P
                "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/../check_${CHECK}.cmake"
        RESULT_VARIABLE status
        OUTPUT_VARIABLE output
        ERROR_VARIABLE output)
    set(${result_status} "${status}" PARENT_SCOPE)
    set(${result_output} "${output}" PARENT_SCOPE)
endfunction()

function(start_tree)
    file(REMOVE_RECURSE "${SCRATCH}")
endfunction()

function(add_file file text)
    file(WRITE "${SCRATCH}/${file}" "${text}")
endfunction()

function(expect_clean)
    run_check(status output)
    if(NOT status EQUAL 0)
        message(SEND_ERROR "check_${CHECK} complains about a clean tree:\n${output}")
    endif()
endfunction()

# expect_violation(PATTERN FILE TEXT): adds FILE, expects a complaint that matches PATTERN, removes it.
function(expect_violation pattern file text)
    add_file("${file}" "${text}")
    run_check(status output)
    string(REGEX REPLACE "[ \n]+" " " output "${output}")
    if(status EQUAL 0 OR NOT output MATCHES "${pattern}")
        message(SEND_ERROR "check_${CHECK} does not find '${pattern}' in ${file}; it says:\n${output}")
    endif()
    file(REMOVE "${SCRATCH}/${file}")
endfunction()
