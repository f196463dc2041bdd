# Finds every library that patina stands on. Each heavy one is linked by the single layer that wraps it.

set(CMAKE_THREAD_PREFER_PTHREAD ON)
find_package(Threads REQUIRED)
find_package(TBB REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(embree 3 REQUIRED)
find_package(OpenImageIO REQUIRED)
find_package(nlohmann_json 3 REQUIRED)
find_package(CLI11 2 REQUIRED)
find_package(fmt REQUIRED)
find_package(nanoflann REQUIRED)

# Debian 12's OpenImageIO target names the header folder of OpenCV, which its -dev package does not
# depend on; CMake then refuses the target. Headers of OpenCV are not needed: drop the folder.
get_target_property(oiio_include_directories OpenImageIO::OpenImageIO INTERFACE_INCLUDE_DIRECTORIES)
list(FILTER oiio_include_directories EXCLUDE REGEX "opencv")
set_target_properties(
    OpenImageIO::OpenImageIO PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${oiio_include_directories}")

find_path(TINYOBJLOADER_INCLUDE_DIR tiny_obj_loader.h REQUIRED)
find_path(TINYGLTF_INCLUDE_DIR tiny_gltf.h REQUIRED)

if(PATINA_BUILD_TESTS)
    find_package(GTest REQUIRED)
    include(GoogleTest)
endif()
if(PATINA_BUILD_BENCH)
    find_package(benchmark REQUIRED)
endif()

# What every target of the project is compiled with.
# -ffp-contract=off and no fast-math: the same bytes out for any number of threads and any SIMD width.
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
              $<$<BOOL:${PATINA_WARNINGS_AS_ERRORS}>:-Werror>)
target_include_directories(patina_flags INTERFACE "${CMAKE_SOURCE_DIR}/src")
target_link_libraries(patina_flags INTERFACE Eigen3::Eigen fmt::fmt)
