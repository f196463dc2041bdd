# Is each heavy outside library included in one .cpp file of src only, and in that file's own test?
include("${CMAKE_CURRENT_LIST_DIR}/lint.cmake")

set(libraries
    "embree3/"
    "(OpenEXR/)?Imf"
    "png\\.h"
    "tiffio\\.h"
    "(oneapi/)?tbb/"
    "tiny_obj_loader\\.h"
    "tiny_gltf\\.h"
    "nanoflann\\.hpp")

lint_files(files src EXTENSIONS h cpp)
foreach(library IN LISTS libraries)
    set(wrapper "")
    foreach(file IN LISTS files)
        lint_includes(names ${file})
        list(FILTER names INCLUDE REGEX "^[<\"]${library}")
        if(NOT names)
            continue()
        endif()
        if(NOT file MATCHES "\\.cpp$")
            lint_violation(${file} "includes ${names} (outside libraries stay in a .cpp)")
        elseif(wrapper)
            string(REGEX REPLACE "\\.cpp$" "_test.cpp" wrapper_test "${wrapper}")
            if(file STREQUAL wrapper_test)
                continue()
            endif()
            lint_violation(${file} "includes ${names}, which ${wrapper} wraps already")
        else()
            set(wrapper ${file})
        endif()
    endforeach()
endforeach()
