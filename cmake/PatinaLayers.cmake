# The layer table: it makes the targets and is what tests/lint checks.
#
# A file includes its own folder and folders of a lower number only; two folders of one number do not
# see each other.
set(PATINA_LAYERS
    base=0
    math=1
    image=2
    reflectance=2
    scene=3
    raytrace=4
    capture=4
    transport=5
    observe=5
    estimate=6
    plan=7
    scan=7
    export=7
    pipeline=8)

function(patina_layer_level layer result)
    foreach(entry IN LISTS PATINA_LAYERS)
        if(entry MATCHES "^${layer}=([0-9]+)$")
            set(${result} "${CMAKE_MATCH_1}" PARENT_SCOPE)
            return()
        endif()
    endforeach()
    message(FATAL_ERROR "'${layer}' is not in PATINA_LAYERS")
endfunction()

# patina_add_layer(NAME SOURCES a.cpp ... [TESTS a_test.cpp ...] [WRAPS target ...])
#
# Makes the library patina_NAME, linked to every layer below it, and the test program patina_NAME_test.
# WRAPS: outside libraries that only this layer uses; they stay private to it.
function(patina_add_layer layer)
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;TESTS;WRAPS")
    patina_layer_level(${layer} level)
    add_library(patina_${layer} STATIC ${arg_SOURCES})
    target_link_libraries(patina_${layer} PUBLIC patina_flags)
    foreach(entry IN LISTS PATINA_LAYERS)
        string(REGEX MATCH "^([a-z]+)=([0-9]+)$" matched "${entry}")
        if(CMAKE_MATCH_2 LESS level)
            target_link_libraries(patina_${layer} PUBLIC patina_${CMAKE_MATCH_1})
        endif()
    endforeach()
    target_link_libraries(patina_${layer} PRIVATE ${arg_WRAPS})
    if(PATINA_BUILD_TESTS AND arg_TESTS)
        patina_add_test(patina_${layer}_test SOURCES ${arg_TESTS} LINKS patina_${layer} ${arg_WRAPS})
    endif()
endfunction()

# patina_add_test(NAME SOURCES a_test.cpp ... LINKS target ... [LABEL label])
function(patina_add_test name)
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "LABEL" "SOURCES;LINKS")
    if(NOT arg_LABEL)
        set(arg_LABEL unit)
    endif()
    add_executable(${name} ${arg_SOURCES})
    target_link_libraries(${name} PRIVATE ${arg_LINKS} GTest::gmock GTest::gtest_main)
    # Helpers of many tests: "support/<file>.h".
    target_include_directories(${name} PRIVATE "${CMAKE_SOURCE_DIR}/tests")
    target_compile_definitions(${name} PRIVATE "PATINA_SOURCE_DIR=\"${CMAKE_SOURCE_DIR}\"")
    # One process for all of a program's tests: starting one for each takes longer than most tests.
    add_test(NAME ${name} COMMAND ${name})
    set_tests_properties(${name} PROPERTIES LABELS ${arg_LABEL} TIMEOUT 900)
endfunction()

function(patina_add_all_layers)
    foreach(entry IN LISTS PATINA_LAYERS)
        string(REGEX REPLACE "=.*" "" layer "${entry}")
        add_subdirectory("${CMAKE_SOURCE_DIR}/src/patina/${layer}" "${CMAKE_BINARY_DIR}/layers/${layer}")
    endforeach()
endfunction()
