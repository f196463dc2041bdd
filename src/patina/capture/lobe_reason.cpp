#include "patina/capture/lobe_reason.h"

#include <cstddef>

namespace patina {
namespace {

struct Words {
    const char* name;
    const char* words;
};

constexpr std::array<Words, kLobeReasons.size()> kWords = {
    {{"off_surface", "off the surface"},
     {"measured", "measured"},
     {"matte", "measured to be matte"},
     {"no_lamp_in_lobe", "no lamp in the lobe"},
     {"narrow_baseline", "lobe wider than the lamps' baseline"},
     {"few_angles", "too few angles to tell the width"},
     {"noise", "lobe drowned in noise"},
     {"unconfirmed", "not confirmed"},
     {"not_observed", "not observed"}}};

}  // namespace

const char* lobe_reason_name(LobeReason reason) { return kWords[std::size_t(reason)].name; }

const char* lobe_reason_words(LobeReason reason) { return kWords[std::size_t(reason)].words; }

}  // namespace patina
