// The rows of a texel's fit: its looks under the light of the present iteration.
#pragma once

#include "patina/estimate/indirect.h"
#include "patina/estimate/observations.h"
#include "patina/estimate/texel_fit.h"

#include <vector>

namespace patina {

// FitRowMaker::expect() is told of the texel that comes so many after the one in hand.
inline constexpr std::size_t kTexelsAhead = 4;

class FitRowMaker {
  public:
    FitRowMaker(const SceneView& scene, const Observations& observations)
        : scene_(scene), observations_(observations) {}

    // The true intensities of the lamps over the stated ones, 1 at first [-]; > 0. Rows hold the
    // radiance over it, so that they fit the lamps as stated.
    void set_lamp_factor(double factor) { lamp_factor_ = factor; }

    // map: the texel's present maps, for the noise that the indirect light adds.
    void make(std::size_t texel,
              const IndirectLight& light,
              const Reflectance& map,
              std::vector<FitRow>& rows) const;

    // Asks for the light that make() will read of this texel: it lies all over memory.
    void expect(std::size_t texel, const IndirectLight& light) const;

  private:
    const SceneView& scene_;
    const Observations& observations_;
    double lamp_factor_ = 1;
};

}  // namespace patina
