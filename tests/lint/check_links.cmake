# Do the relative links of the Markdown pages lead to files?
include("${CMAKE_CURRENT_LIST_DIR}/lint.cmake")

lint_files(files docs examples EXTENSIONS md)
file(GLOB root_files RELATIVE "${PATINA_ROOT}" "${PATINA_ROOT}/*.md")
list(APPEND files ${root_files})
foreach(file IN LISTS files)
    get_filename_component(folder "${PATINA_ROOT}/${file}" DIRECTORY)
    file(READ "${PATINA_ROOT}/${file}" text)
    # Square brackets and semicolons would upset CMake's lists; the part between parentheses has neither.
    string(REGEX REPLACE "[][;]" "|" text "${text}")
    string(REGEX MATCHALL "\\|\\([^()# \n]+" links "${text}")
    foreach(link IN LISTS links)
        string(SUBSTRING "${link}" 2 -1 target)
        if(NOT target MATCHES "^[a-z]+:" AND NOT EXISTS "${folder}/${target}")
            lint_violation(${file} "links to ${target}, which does not exist")
        endif()
    endforeach()
endforeach()
