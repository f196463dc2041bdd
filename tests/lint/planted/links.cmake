include("${CMAKE_CURRENT_LIST_DIR}/planted.cmake")

start_tree()
add_file(README.md "See [a; b](docs/use.md), [c](https://example.org/x) and [d](#below); f(x).\n")
add_file(docs/use.md "![picture](figures/a.png) [back](../README.md#top)\n")
add_file(docs/figures/a.png "")
expect_clean()
expect_violation("links to nowhere.md" docs/bad.md "Line\n\n| [a](use.md) | [b](nowhere.md#x) |\n")
expect_violation("links to docs/none.md" CHANGES.md "[x](docs/none.md)\n")
