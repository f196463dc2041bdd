// Why the lobe of a texel is measured or not: the values of reason.exr.
#pragma once

#include <array>

namespace patina {

// Of what is not measured: docs/uncertainty.md, "What can be measured".
enum class LobeReason {
    off_surface = 0,      // every map is 0 here
    measured = 1,         // Ps and sigma
    matte = 2,            // Ps, which is not told from 0, so that it has no width
    no_lamp_in_lobe = 3,  // no look comes near enough to the mirror direction
    narrow_baseline = 4,  // looks lie in the lobe, but it hardly varies: Pd and Ps are confounded
    few_angles = 5,       // Pd and Ps would be told apart, but Ps and sigma are not
    noise = 6,            // the lobe is too faint for the noise
    unconfirmed = 7,      // a lobe as filled would show: the looks or the neighbours contradict it
    not_observed = 8,     // never usefully seen
};
inline constexpr std::array<LobeReason, 9> kLobeReasons = {LobeReason::off_surface,
                                                           LobeReason::measured,
                                                           LobeReason::matte,
                                                           LobeReason::no_lamp_in_lobe,
                                                           LobeReason::narrow_baseline,
                                                           LobeReason::few_angles,
                                                           LobeReason::noise,
                                                           LobeReason::unconfirmed,
                                                           LobeReason::not_observed};

// As in result.json: "no_lamp_in_lobe".
[[nodiscard]] const char* lobe_reason_name(LobeReason reason);
// For a reader: "no lamp in the lobe".
[[nodiscard]] const char* lobe_reason_words(LobeReason reason);

}  // namespace patina
