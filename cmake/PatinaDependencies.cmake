# Finds every library that patina stands on. Each heavy one is linked by the single layer that wraps it.

set(CMAKE_THREAD_PREFER_PTHREAD ON)
find_package(Threads REQUIRED)
find_package(TBB REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(embree 3 REQUIRED)
find_package(nlohmann_json 3 REQUIRED)
find_package(CLI11 2 REQUIRED)
find_package(fmt REQUIRED)
find_package(nanoflann REQUIRED)
find_package(OpenEXR 3 REQUIRED CONFIG)
find_package(PNG REQUIRED)
find_package(TIFF 4.5 REQUIRED)

find_path(TINYOBJLOADER_INCLUDE_DIR tiny_obj_loader.h REQUIRED)
find_path(TINYGLTF_INCLUDE_DIR tiny_gltf.h REQUIRED)

if(PATINA_BUILD_TESTS)
    find_package(GTest REQUIRED)
endif()
if(PATINA_BUILD_BENCH)
    find_package(benchmark REQUIRED)
endif()

# What every target of the project is compiled with.
# -ffp-contract=off and no fast-math: the same bytes out for any number of threads and any SIMD width.
# Nobody reads errno or floating-point exceptions; while the compiler must keep them, a loop with a
# maximum, a choice or a root in it stays scalar.
add_library(patina_flags INTERFACE)
target_compile_features(patina_flags INTERFACE cxx_std_20)
target_compile_definitions(patina_flags INTERFACE EIGEN_MPL2_ONLY EIGEN_DONT_PARALLELIZE)
target_compile_options(
    patina_flags
    INTERFACE -Wall
              -Wextra
              -Wpedantic
              -Wshadow
              -Wnon-virtual-dtor
              -Wold-style-cast
              -Wcast-align
              -Woverloaded-virtual
              -ffp-contract=off
              -fno-math-errno
              -fno-trapping-math
              # False alarms on "text" + std::string, gone in GCC 13 (GCC bug 105651).
              $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-restrict>
              $<$<BOOL:${PATINA_WARNINGS_AS_ERRORS}>:-Werror>)
# Eight single-precision lanes. Embree is pinned to the same instruction set (raytrace/tracer.cpp).
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    target_compile_options(patina_flags INTERFACE -march=x86-64-v3)
endif()
target_include_directories(patina_flags INTERFACE "${CMAKE_SOURCE_DIR}/src")
target_link_libraries(patina_flags INTERFACE Eigen3::Eigen fmt::fmt)
