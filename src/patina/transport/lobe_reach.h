// How far from its mirror direction a lobe looks for indirect light.
#pragma once

namespace patina {

// In sigma of the widest of the three lobes of indirect_lobe(): beyond it nothing is added, 1 % of
// that one's light and less than 1e-7 of the middle one's.
inline constexpr float kLobeReach = 3.0f;

// The same as the chord between two unit vectors, for a texel's sigma [rad], twice of which is that
// of the widest lobe [-].
[[nodiscard]] inline float lobe_reach_chord(float roughness) { return kLobeReach * 2 * roughness; }

}  // namespace patina
