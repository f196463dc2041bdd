include("${CMAKE_CURRENT_LIST_DIR}/planted.cmake")

start_tree()
add_file(src/patina/base/a.cpp
         "#if 0x20 > 3\n#endif\n// todos are fine; MAX_TODO_X too; see src/work/x\n")
add_file(docs/use.md "Naïve – write to a temporary folder or https://example.org/home/page\n")
expect_clean()
expect_violation("note to self" src/patina/base/bad.h "int a; // TODO: later\n")
expect_violation("note to self" tools/bad "# FIXME\n")
expect_violation("dead code" src/patina/base/bad.cpp "  # if 0\n")
expect_violation("path of one machine" docs/bad.md "as in \"/home/ann/captures\"\n")
expect_violation("path of one machine" README.md "cd /root/x – ok\n")
expect_violation("package registry" .ci/run "curl http://deb.example.org/debian\n")
expect_violation("package registry" web/package-lock.json "\"https://registry.example.org/three\"\n")
