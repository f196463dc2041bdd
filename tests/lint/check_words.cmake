# Are there notes to self, dead code, paths of one machine, or addresses of package registries?
include("${CMAKE_CURRENT_LIST_DIR}/lint.cmake")

set(note_words "TODO|FIXME|XXX|HACK")
set(dead_code "#[ \t]*if[ \t]+0")
set(machine_paths "/(home|root|work|Users|mnt|srv)/[A-Za-z0-9_]|[A-Z]:\\\\\\\\?Users")
set(registries
    "https?://(registry|deb|security|snapshot|archive|ports|pypi|files|crates|proxy)\\.")
list(JOIN registries "|" registries)

function(check_word file pattern why)
    file(STRINGS "${PATINA_ROOT}/${file}" lines REGEX "${pattern}" ENCODING UTF-8)
    if(lines)
        list(GET lines 0 line)
        string(STRIP "${line}" line)
        lint_violation(${file} "${why}: ${line}")
    endif()
endfunction()

lint_files(
    files src apps tests bench examples python web docs cmake tools .ci
    EXTENSIONS h cpp in py pyi ts tsx js css html json md txt cmake bib)
file(GLOB root_files RELATIVE "${PATINA_ROOT}" "${PATINA_ROOT}/*.md" "${PATINA_ROOT}/*.txt"
     "${PATINA_ROOT}/*.json" "${PATINA_ROOT}/*.cff" "${PATINA_ROOT}/tools/*" "${PATINA_ROOT}/.ci/*")
list(APPEND files ${root_files})
# These files hold the words that they look for.
list(FILTER files EXCLUDE REGEX "^tests/lint/")
foreach(file IN LISTS files)
    check_word(${file} "(^|[^A-Za-z0-9_])(${note_words})([^A-Za-z0-9_]|$)" "a note to self")
    check_word(${file} "^[ \t]*${dead_code}([^0-9xX]|$)" "dead code")
    check_word(${file} "(^|[^A-Za-z0-9_.])(${machine_paths})" "a path of one machine")
    check_word(${file} "${registries}" "the address of a package registry")
endforeach()
