include("${CMAKE_CURRENT_LIST_DIR}/planted.cmake")

start_tree()
add_file(src/patina/math/a.h
         "#include \"patina/base/error.h\"\n#include \"patina/math/b.h\"\n#include <vector>\n")
add_file(apps/patina/main.cpp "#include \"commands.h\"\n#include \"patina/pipeline/estimate.h\"\n")
expect_clean()
expect_violation("layer math \\(1\\) includes .*of layer scene \\(3\\)" src/patina/math/bad.h
                 "#include \"patina/scene/mesh.h\"\n")
expect_violation("layer image \\(2\\) includes .*of layer reflectance \\(2\\)" src/patina/image/bad.cpp
                 "  # include \"patina/reflectance/lobe.h\"\n")
expect_violation("no relative includes" src/patina/math/bad.h "#include \"../base/error.h\"\n")
expect_violation("no relative includes" src/patina/math/bad.h "#include \"patina/../x.h\"\n")
expect_violation("expected .patina/" src/patina/math/bad.cpp "#include \"bad.h\"\n")
expect_violation("in quotes" src/patina/math/bad.cpp "#include <patina/base/error.h>\n")
expect_violation("'nowhere' is not in PATINA_LAYERS" src/patina/math/bad.cpp
                 "#include \"patina/nowhere/x.h\"\n")
