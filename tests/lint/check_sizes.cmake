# Is every file short enough to be read in one sitting?
include("${CMAKE_CURRENT_LIST_DIR}/lint.cmake")

set(max_lines 400)
set(max_test_lines 600)

lint_files(files src apps tests bench examples python EXTENSIONS h cpp py)
foreach(file IN LISTS files)
    file(READ "${PATINA_ROOT}/${file}" text)
    string(REGEX MATCHALL "\n" newlines "${text}")
    list(LENGTH newlines num_lines)
    set(limit ${max_lines})
    if(file MATCHES "_test\\.|^tests/")
        set(limit ${max_test_lines})
    endif()
    if(num_lines GREATER limit)
        lint_violation(${file} "has ${num_lines} lines (expected at most ${limit})")
    endif()
endforeach()
