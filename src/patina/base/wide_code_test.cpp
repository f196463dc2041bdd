#include "patina/base/wide_code.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>

namespace patina {
namespace {

using Numbers = std::array<float, 103>;  // whole registers and a rest

Numbers roots_of_sums() {
    Numbers result;
    run_wide([&]() PATINA_WIDE {
        for (std::size_t i = 0; i < result.size(); ++i) {
            const auto x = float(i);
            result[i] = std::sqrt(x * 0.37f + 0.1f) / (x + 3.0f);
        }
    });
    return result;
}

TEST(RunWide, GivesTheSameBytesWithAvx512AndWithout) {
    const Numbers wide = roots_of_sums();
    const NarrowCode narrow_code;
    const Numbers narrow = roots_of_sums();
    for (std::size_t i = 0; i < wide.size(); ++i) {
        EXPECT_EQ(wide[i], narrow[i]) << i;
        const double x = double(i);
        const double exact = std::sqrt(x * 0.37 + 0.1) / (x + 3);
        EXPECT_NEAR(double(wide[i]), exact, 1e-6 * exact) << i;
    }
}

TEST(NarrowCode, HoldsWhileItLives) {
    const bool before = takes_avx512();
    {
        const NarrowCode outer;
        { const NarrowCode inner; }
        EXPECT_FALSE(takes_avx512());
    }
    EXPECT_EQ(takes_avx512(), before);
}

}  // namespace
}  // namespace patina
