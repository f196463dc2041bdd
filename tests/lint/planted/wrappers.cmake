include("${CMAKE_CURRENT_LIST_DIR}/planted.cmake")

start_tree()
add_file(src/patina/base/parallel.cpp
         "#include <oneapi/tbb/parallel_for.h>\n#include <oneapi/tbb/global_control.h>\n")
add_file(src/patina/raytrace/tracer.cpp "#include <embree3/rtcore.h>\n")
add_file(src/patina/raytrace/tracer_test.cpp "#include <embree3/rtcore.h>\n")
add_file(src/patina/scene/mesh_io.cpp "#include <tiny_gltf.h>\n#include <tiny_obj_loader.h>\n")
expect_clean()
expect_violation("stay in a .cpp" src/patina/image/bad.h "#include <OpenEXR/ImfHeader.h>\n")
expect_violation("tracer.cpp wraps already" src/patina/scan/bad.cpp "#include <embree3/rtcore.h>\n")
expect_violation("parallel.cpp wraps already" src/patina/scan/bad.cpp "#include <tbb/task_group.h>\n")
expect_violation("mesh_io.cpp wraps already" src/patina/scene/other.cpp "#include \"tiny_gltf.h\"\n")
expect_violation("tracer.cpp wraps already" src/patina/scan/bad_test.cpp "#include <embree3/rtcore.h>\n")
