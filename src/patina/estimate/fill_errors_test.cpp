#include "patina/estimate/fill_errors.h"

#include "patina/base/random.h"

#include <gtest/gtest.h>

#include "support/scenes.h"
#include <cmath>
#include <vector>

namespace patina {
namespace {

constexpr int kSide = 32;
constexpr double kOwnError = 0.1;  // relative, of measured Ps and sigma

class FillErrors : public testing::Test {
  protected:
    FillErrors() : maps_(atlas_.texels.size()), errors_(maps_.size()), measured_(maps_.size(), 0) {
        for (std::size_t i = 0; i < maps_.size(); ++i) {
            maps_[i] = {Rgb::Constant(0.5), 0.4, 0.15};
            errors_[i].specular = kOwnError * maps_[i].specular;
            errors_[i].roughness = kOwnError * maps_[i].roughness;
        }
    }
    [[nodiscard]] std::vector<LobeSpread> find() const {
        return fill_errors(atlas_, maps_, errors_, measured_);
    }
    void measure_columns(int below) {
        for (std::size_t i = 0; i < maps_.size(); ++i) {
            measured_[i] = atlas_.texels[i].column < below;
        }
    }

    TexelAtlas atlas_ =
        build_atlas(rectangle(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()), kSide, kSide);
    std::vector<Reflectance> maps_;
    std::vector<Reflectance> errors_;
    std::vector<std::uint8_t> measured_;
};

TEST_F(FillErrors, AreInfiniteWhereNothingIsMeasured) {
    for (const LobeSpread& spread : find()) {
        EXPECT_TRUE(std::isinf(spread.specular_albedo));
        EXPECT_TRUE(std::isinf(spread.roughness));
    }
}

TEST_F(FillErrors, AreTheSourcesOwnOnOneMaterial) {
    measure_columns(kSide / 2);
    const std::vector<LobeSpread> spread = find();
    for (std::size_t i = 0; i < spread.size(); ++i) {
        EXPECT_NEAR(spread[i].roughness, measured_[i] != 0 ? 0 : kOwnError, 1e-12);
        EXPECT_NEAR(spread[i].specular_albedo, measured_[i] != 0 ? 0 : kOwnError, 1e-12);
    }
}

TEST_F(FillErrors, GrowWithTheDistanceOnAMaterialThatVaries) {
    constexpr double kSlope = 0.02;  // of ln sigma per texel
    for (std::size_t i = 0; i < maps_.size(); ++i) {
        maps_[i].roughness = 0.1 * std::exp(kSlope * atlas_.texels[i].column);
        maps_[i].specular = 0.01 / square(maps_[i].roughness);
        errors_[i] = {Rgb::Zero(), 0, 0};
    }
    measure_columns(kSide / 2);
    const std::vector<LobeSpread> spread = find();
    double previous = 0;
    for (std::size_t i = 0; i < spread.size(); ++i) {
        const Texel& texel = atlas_.texels[i];
        if (texel.row != kSide / 2 || measured_[i] != 0) continue;
        const int distance = texel.column - kSide / 2 + 1;
        EXPECT_GE(spread[i].roughness, previous);
        // Half of the pairs lie along the columns and do not differ; columns 1, 2, 4 ... apart are
        // read with straight lines between.
        if (distance <= 8) {
            EXPECT_NEAR(
                spread[i].roughness, kSlope * distance / std::sqrt(2.0), 0.25 * kSlope * distance);
        }
        EXPECT_NEAR(spread[i].specular_albedo, 0, 1e-6);
        previous = spread[i].roughness;
    }
}

TEST_F(FillErrors, DoNotComparePairsOfUnlikeColour) {
    for (std::size_t i = 0; i < maps_.size(); ++i) {
        if (atlas_.texels[i].row % 2 == 0) continue;
        maps_[i].diffuse = Rgb(0.1, 0.2, 0.6);
        maps_[i].roughness = 0.3;
    }
    for (Reflectance& error : errors_) error = {Rgb::Zero(), 0, 0};
    measure_columns(kSide / 2);
    for (const LobeSpread& spread : find()) EXPECT_NEAR(spread.roughness, 0, 1e-12);
}

}  // namespace
}  // namespace patina
