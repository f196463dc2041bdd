#include "patina/transport/surface_filter.h"

#include "patina/base/parallel.h"
#include "patina/math/warp.h"
#include "patina/transport/ratio_kernel.h"

#include <Eigen/Dense>

namespace patina {
namespace {

// A plane has three unknowns; from so few more texels on, it is a mean that removes noise.
constexpr std::size_t kMinTexels = 5;
// Smallest over largest eigenvalue of the regression's matrix: below, the neighbours lie on a line.
constexpr double kMinCondition = 1e-3;

// Turns the kernel weights of one row into those of the regression. False: not determined.
bool regress(const TexelAtlas& atlas,
             TexelId center,
             std::span<const TexelId> texels,
             std::span<float> weights) {
    if (texels.size() < kMinTexels) return false;
    const Texel& middle = atlas.texels[center];
    const Frame frame(middle.point.normal);
    const double size = std::sqrt(middle.area);
    const auto basis = [&](TexelId texel) {
        const Vec3 offset = (atlas.texels[texel].point.position - middle.point.position) / size;
        return Vec3(1, offset.dot(frame.tangent), offset.dot(frame.bitangent));
    };
    Mat3 matrix = Mat3::Zero();
    for (std::size_t k = 0; k < texels.size(); ++k) {
        const Vec3 b = basis(texels[k]);
        matrix += double(weights[k]) * b * b.transpose();
    }
    Eigen::SelfAdjointEigenSolver<Mat3> solver;
    solver.computeDirect(matrix, Eigen::EigenvaluesOnly);
    if (!(solver.eigenvalues()[0] > kMinCondition * solver.eigenvalues()[2])) return false;
    const Vec3 plane = matrix.ldlt().solve(Vec3::UnitX());
    for (std::size_t k = 0; k < texels.size(); ++k) {
        weights[k] = float(double(weights[k]) * basis(texels[k]).dot(plane));
    }
    return true;
}

}  // namespace

SurfaceFilter build_surface_filter(const TexelAtlas& atlas, double radius) {
    // With a photon in every texel, kernels are as large as their smallest radius.
    RatioKernelOptions options;
    options.arrivals = 0.5;
    options.min_radius = radius;
    options.max_radius = 2 * radius;
    RatioKernel kernel =
        build_ratio_kernel(atlas, std::vector<double>(atlas.texels.size(), 1.0), options);
    parallel_for(atlas.texels.size(), [&](std::size_t i) {
        const std::size_t begin = kernel.begin[i];
        const std::size_t count = kernel.begin[i + 1] - begin;
        const std::span<float> weights = std::span(kernel.weight).subspan(begin, count);
        const std::span<const TexelId> texels = std::span(kernel.texel).subspan(begin, count);
        if (regress(atlas, TexelId(i), texels, weights)) return;
        for (std::size_t k = 0; k < count; ++k) weights[k] = texels[k] == i ? 1.0f : 0.0f;
    });
    return {std::move(kernel.begin), std::move(kernel.texel), std::move(kernel.weight)};
}

}  // namespace patina
