#include "patina/base/check.h"

#include <cstdio>
#include <cstdlib>

namespace patina {

void check_failed(const char* file, int line, const char* expression, const std::string& values) {
    std::fprintf(stderr,
                 "patina: internal error: %s:%d: %s does not hold%s%s\n",
                 file,
                 line,
                 expression,
                 values.empty() ? "" : ": ",
                 values.c_str());
    std::abort();
}

}  // namespace patina
