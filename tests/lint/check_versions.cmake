# Do CMakeLists.txt, CITATION.cff and the newest heading of CHANGELOG.md name the same version?
include("${CMAKE_CURRENT_LIST_DIR}/lint.cmake")

# read_version(RESULT FILE PATTERN): the first group of PATTERN in its first match.
function(read_version result file pattern)
    file(READ "${PATINA_ROOT}/${file}" text)
    if(NOT text MATCHES "${pattern}")
        message(FATAL_ERROR "${file}: has no version (expected a match of ${pattern})")
    endif()
    set(${result} "${CMAKE_MATCH_1}" PARENT_SCOPE)
endfunction()

set(number "[0-9]+\\.[0-9]+\\.[0-9]+")
read_version(project_version CMakeLists.txt "VERSION (${number})\n")
read_version(citation_version CITATION.cff "\nversion: (${number})\n")
read_version(changelog_version CHANGELOG.md "\n## (${number})")
foreach(file IN ITEMS citation changelog)
    if(NOT ${file}_version VERSION_EQUAL project_version)
        lint_violation("${file}" "is at ${${file}_version} (CMakeLists.txt: ${project_version})")
    endif()
endforeach()
