// The program's version, as CMake states it.
#pragma once

#include <string>

namespace patina {

// "0.1.0".
[[nodiscard]] std::string program_version();

}  // namespace patina
