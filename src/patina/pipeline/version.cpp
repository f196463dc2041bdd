#include "patina/pipeline/version.h"

namespace patina {

std::string program_version() { return PATINA_VERSION; }

}  // namespace patina
