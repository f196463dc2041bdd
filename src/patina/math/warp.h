// Local frames, and warps of the unit square to directions with their densities.
//
// Based on: Duff et al. Building an Orthonormal Basis, Revisited. JCGT 6(1), 2017 (Frame).
// Based on: Jakob. Numerically stable sampling of the von Mises-Fisher distribution. 2012.
#pragma once

#include "patina/math/types.h"

#include <array>

namespace patina {

// Orthonormal right-handed frame about a unit normal.
struct Frame {
    explicit Frame(const Vec3& unit_normal);
    [[nodiscard]] Vec3 to_world(const Vec3& local) const {
        return tangent * local.x() + bitangent * local.y() + normal * local.z();
    }
    Vec3 tangent;
    Vec3 bitangent;
    Vec3 normal;
};

// Direction with density cos(theta)/pi about +z [1/sr].
[[nodiscard]] Vec3 square_to_cosine_hemisphere(const std::array<double, 2>& u);
// Uniform direction on the sphere, density 1/(4 pi) [1/sr].
[[nodiscard]] Vec3 square_to_sphere(const std::array<double, 2>& u);
// Direction about +z of the von Mises-Fisher distribution with concentration kappa > 0.
[[nodiscard]] Vec3 square_to_von_mises_fisher(const std::array<double, 2>& u, double kappa);
// Its density [1/sr] at an angle of cosine cos_theta from the axis.
[[nodiscard]] double von_mises_fisher_pdf(double cos_theta, double kappa);

}  // namespace patina
