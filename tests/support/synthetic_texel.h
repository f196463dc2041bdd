// The looks at one texel of known reflectance, without any scene.
#pragma once

#include "patina/base/random.h"
#include "patina/estimate/texel_fit.h"

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace patina {

// One lamp per look. Mirror angles are spread evenly over [0, reach]; irradiance and cosines vary
// from look to look, so that the diffuse and the specular part are not proportional.
class SyntheticTexel {
  public:
    SyntheticTexel(std::size_t num_looks, double reach) : lamps_(num_looks), rows_(num_looks) {
        for (std::size_t k = 0; k < num_looks; ++k) {
            const double share = num_looks > 1 ? double(k) / double(num_looks - 1) : 0;
            const double wave = std::sin(2.4 * double(k));
            LampTerm& lamp = lamps_[k];
            lamp.irradiance = Rgbf(2.0f, 1.8f, 1.5f) * float(1 + 0.3 * wave);
            lamp.theta_r_squared = float(square(reach * share));
            lamp.lobe_cosines = float(1.3 - 0.2 * wave);
            FitRow& row = rows_[k];
            row.lamps = std::span(&lamp, 1);
            row.theta_r = reach * share;
            row.irradiance = lamp.irradiance.cast<double>();
            row.weight = Rgb::Ones();
        }
    }
    // The rows point into the lamps.
    SyntheticTexel(const SyntheticTexel&) = delete;
    SyntheticTexel& operator=(const SyntheticTexel&) = delete;

    [[nodiscard]] std::span<FitRow> rows() { return rows_; }

    // Lets every look show a patch over which the mirror direction varies so much [rad^2].
    void spread(float along, float across) {
        for (LampTerm& lamp : lamps_) {
            lamp.spread_along = along;
            lamp.spread_across = across;
        }
    }

    // Look k has its lamp so far from the mirror direction [rad], at the same cosines as the
    // others.
    void place_lamp(std::size_t k, double theta_r) {
        lamps_[k].theta_r_squared = float(square(theta_r));
        lamps_[k].lobe_cosines = 1.3f;
        rows_[k].theta_r = theta_r;
    }

    void classify(const FitOptions& options) {
        for (FitRow& row : rows_) row.pixel_class = classify_by_angle(row, options);
    }
    void show(const Reflectance& truth) {
        for (FitRow& row : rows_) row.radiance = predict(row, truth);
    }
    // Radiance with normal noise of a relative and an absolute part, and its inverse variance.
    void show(const Reflectance& truth, double relative, double absolute, Rng& rng) {
        for (FitRow& row : rows_) {
            const Rgb exact = predict(row, truth);
            const Rgb variance = (relative * exact).square() + square(absolute);
            for (Eigen::Index c = 0; c < 3; ++c) {
                row.radiance[c] = exact[c] + std::sqrt(variance[c]) * rng.normal();
            }
            row.weight = 1 / variance;
        }
    }

  private:
    std::vector<LampTerm> lamps_;
    std::vector<FitRow> rows_;
};

}  // namespace patina
