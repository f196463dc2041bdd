# What the checks share: which files to look at, and how to report.
cmake_minimum_required(VERSION 3.22)

# lint_files(RESULT FOLDER ... EXTENSIONS h cpp ...): paths below the FOLDERs, relative to PATINA_ROOT.
function(lint_files result)
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "EXTENSIONS")
    set(patterns "")
    foreach(folder IN LISTS arg_UNPARSED_ARGUMENTS)
        foreach(extension IN LISTS arg_EXTENSIONS)
            list(APPEND patterns "${PATINA_ROOT}/${folder}/*.${extension}")
        endforeach()
    endforeach()
    file(GLOB_RECURSE files RELATIVE "${PATINA_ROOT}" ${patterns})
    list(FILTER files EXCLUDE REGEX "(^|/)(node_modules|build)/")
    list(SORT files)
    set(${result} "${files}" PARENT_SCOPE)
endfunction()

# lint_includes(RESULT FILE): the included names, each with its quotes or angle brackets.
function(lint_includes result file)
    file(STRINGS "${PATINA_ROOT}/${file}" lines REGEX "^[ \t]*#[ \t]*include" ENCODING UTF-8)
    set(names "")
    foreach(line IN LISTS lines)
        if(line MATCHES "include[ \t]*([<\"][^>\"]*[>\"])")
            list(APPEND names "${CMAKE_MATCH_1}")
        endif()
    endforeach()
    set(${result} "${names}" PARENT_SCOPE)
endfunction()

# lint_violation(FILE MESSAGE): reports one broken rule; the script goes on and fails at its end.
function(lint_violation file message)
    message(SEND_ERROR "${file}: ${message}")
endfunction()
