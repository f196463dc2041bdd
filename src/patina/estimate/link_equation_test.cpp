#include "patina/estimate/link_equation.h"

#include "patina/base/parallel.h"
#include "patina/base/random.h"

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "support/scenes.h"
#include <algorithm>
#include <vector>

namespace patina {
namespace {

constexpr int kSide = 12;
// More unknown texels than one block of a sum.
constexpr int kLongSide = 100;

// A plate of which two texels in three are unknown, with links and right sides at random.
class Plate {
  public:
    explicit Plate(int side)
        : atlas(build_atlas(rectangle(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()), side, side)),
          link(atlas.neighbors.size()),
          is_unknown(atlas.texels.size()) {
        Rng rng(2, Pass::tests, 0);
        for (std::size_t i = 0; i < atlas.texels.size(); ++i) {
            is_unknown[i] = i % 3 != 0;
            each_link(i, [&](std::size_t k, std::size_t j) {
                // The same in both directions: that of the smaller texel is drawn first.
                if (i < j) link[k] = float(0.1 + rng.uniform());
                if (i > j)
                    each_link(j, [&](std::size_t m, std::size_t other) {
                        if (other == i) link[k] = link[m];
                    });
            });
        }
        for (std::size_t i = 0; i < atlas.texels.size(); ++i) {
            if (!is_unknown[i]) continue;
            double diagonal = 0.01;
            each_link(i, [&](std::size_t k, std::size_t) { diagonal += double(link[k]); });
            equation.unknown.push_back(TexelId(i));
            equation.diagonal.push_back(diagonal);
            equation.right.push_back(rng.normal());
        }
    }

    // The same by a dense factorisation.
    [[nodiscard]] Eigen::VectorXd expected() const {
        const auto n = Eigen::Index(atlas.texels.size());
        Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(n, n);
        Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
        for (std::size_t row = 0; row < equation.unknown.size(); ++row) {
            const std::size_t i = equation.unknown[row];
            matrix(Eigen::Index(i), Eigen::Index(i)) = equation.diagonal[row];
            right[Eigen::Index(i)] = equation.right[row];
            each_link(i, [&](std::size_t k, std::size_t j) {
                if (is_unknown[j]) matrix(Eigen::Index(i), Eigen::Index(j)) = -double(link[k]);
            });
        }
        return matrix.ldlt().solve(right);
    }

    template <typename Use>
    void each_link(std::size_t texel, const Use& use) const {
        for (std::uint32_t k = atlas.neighbor_begin[texel]; k < atlas.neighbor_begin[texel + 1];
             ++k) {
            use(k, atlas.neighbors[k]);
        }
    }

    TexelAtlas atlas;
    std::vector<float> link;
    std::vector<bool> is_unknown;
    LinkEquation equation;
};

TEST(SolveLinks, FindsWhatADenseFactorisationFinds) {
    const Plate plate(kSide);
    std::vector<double> values(plate.atlas.texels.size(), 3.0);
    LinkSolverOptions options;
    options.tolerance = 1e-12;
    EXPECT_GT(solve_links(plate.atlas, plate.link, plate.equation, options, values), 5);
    const Eigen::VectorXd expected = plate.expected();
    for (std::size_t i = 0; i < values.size(); ++i) {
        EXPECT_NEAR(values[i], expected[Eigen::Index(i)], 1e-9) << i;
    }
    // From the solution there is nothing left to do.
    EXPECT_EQ(solve_links(plate.atlas, plate.link, plate.equation, {1e-6, 400}, values), 0);
}

TEST(SolveLinks, GivesTheSameBytesForAnyNumberOfThreads) {
    const Plate plate(kLongSide);
    std::vector<double> one(plate.atlas.texels.size(), 0.0);
    std::vector<double> two = one;
    {
        const ThreadLimit limit(1);
        solve_links(plate.atlas, plate.link, plate.equation, {}, one);
    }
    solve_links(plate.atlas, plate.link, plate.equation, {}, two);
    EXPECT_EQ(one, two);
}

TEST(SolveLinks, FindsZeroWhereNothingDrivesIt) {
    Plate plate(kSide);
    std::fill(plate.equation.right.begin(), plate.equation.right.end(), 0.0);
    std::vector<double> values(plate.atlas.texels.size(), 3.0);
    solve_links(plate.atlas, plate.link, plate.equation, {}, values);
    EXPECT_EQ(values, std::vector<double>(values.size(), 0.0));
    // So little that its square is 0.
    std::fill(plate.equation.right.begin(), plate.equation.right.end(), 1e-200);
    solve_links(plate.atlas, plate.link, plate.equation, {}, values);
    for (const double value : values) EXPECT_NEAR(value, 0, 1e-150);
}

TEST(SolveLinks, TakesStepsThatGrowLessThanThePlate) {
    // One corner alone is known and the rest hardly held by itself. By the diagonal, steps grow
    // with the side, here by 4; with constants on cells of all sizes, by its root.
    const auto steps = [](int side) {
        Plate plate(side);
        plate.equation = {};
        for (std::size_t i = 1; i < plate.atlas.texels.size(); ++i) {
            double diagonal = 1e-6;
            double right = 0;
            plate.each_link(i, [&](std::size_t k, std::size_t j) {
                diagonal += double(plate.link[k]);
                if (j == 0) right += double(plate.link[k]);
            });
            plate.equation.unknown.push_back(TexelId(i));
            plate.equation.diagonal.push_back(diagonal);
            plate.equation.right.push_back(right);
        }
        std::vector<double> values(plate.atlas.texels.size(), 0.0);
        return solve_links(plate.atlas, plate.link, plate.equation, {1e-5, 4000}, values);
    };
    const int few = steps(24);
    const int many = steps(4 * 24);
    EXPECT_LT(many, 3 * few) << few << " and " << many;
}

TEST(SolveLinks, StopsAtItsLimit) {
    const Plate plate(kSide);
    std::vector<double> values(plate.atlas.texels.size(), 0.0);
    EXPECT_EQ(solve_links(plate.atlas, plate.link, plate.equation, {0, 3}, values), 3);
}

}  // namespace
}  // namespace patina
