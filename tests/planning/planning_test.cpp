// Lamps for the paper's objects B and C, chosen from geometry alone, judged by the truth: at how
// many texels does the Cramer-Rao bound allow Ps to be known to 10 %?
#include "patina/estimate/texel_fit.h"
#include "patina/plan/lamp_orders.h"
#include "patina/plan/planned_looks.h"
#include "patina/scan/scanner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <span>
#include <string>
#include <vector>

namespace patina {
namespace {

using Order = std::vector<std::size_t>;

constexpr int kColumns = 128;
constexpr int kRows = 80;
constexpr int kDraws = 40;
// From the project's goals: so much better than random and uniform choices.
constexpr double kBetter = 1.1;

// The truth of each texel that the looks are of; texels without are left out of the count.
struct TrueTexels {
    std::vector<Reflectance> reflectance;
    std::vector<std::uint8_t> is_known;
};

class PlannedObject {
  public:
    explicit PlannedObject(ObjectKind kind)
        : scan_(scan_options()),
          object_(make_object(kind, kColumns, kRows)),
          capture_(simulate_rig(object_, scan_)),
          looks_(collect(capture_)),
          truth_(find_truth()),
          noise_{square(scan_.noise_read), scan_.noise_gain} {}

    // From the geometry and the typical surface alone.
    [[nodiscard]] Order by_information(std::size_t count) const {
        const SupposedSurface surface{SurfacePrior{}};
        std::vector<LookGradients> lamps;
        for (const LookTable& table : looks_.candidates) {
            lamps.push_back(look_gradients(table, surface, noise_));
        }
        GreedyOptions options;
        options.max_picks = count;
        return choose_by_information(Knowledge(surface, looks_.texels.ids.size()), lamps, options)
            .picks;
    }

    [[nodiscard]] Order uniform(std::size_t count) const {
        const Order order =
            uniform_order(capture_.description.lights, bounds_of(capture_.mesh).center());
        return {order.begin(), order.begin() + std::ptrdiff_t(count)};
    }

    [[nodiscard]] double mean_of_random(std::size_t count) const {
        double sum = 0;
        for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
            const Order order = random_order(looks_.candidates.size(), 1, draw);
            sum += share_known({order.begin(), order.begin() + std::ptrdiff_t(count)});
        }
        return sum / kDraws;
    }

    // Share of the texels at which the fit of an estimate could know Ps to 10 %.
    [[nodiscard]] double share_known(const Order& lamps) const {
        std::size_t count = 0;
        for (std::size_t i = 0; i < truth_.reflectance.size(); ++i) {
            if (truth_.is_known[i] == 0) continue;
            const double error = specular_error(i, lamps);
            count += std::size_t(error <= kKnown * truth_.reflectance[i].specular);
        }
        const auto total = std::count(truth_.is_known.begin(), truth_.is_known.end(), 1);
        return double(count) / double(total);
    }

  private:
    static ScanOptions scan_options() {
        ScanOptions scan;
        scan.columns = kColumns;
        scan.rows = kRows;
        return scan;
    }

    static PlannedLooks collect(const Capture& capture) {
        Progress progress;
        return collect_planned_looks(RigView(capture, progress), {}, {}, progress);
    }

    [[nodiscard]] TrueTexels find_truth() const {
        const TruthMaps maps = truth_maps(object_, scan_);
        TrueTexels truth;
        for (const TexelId id : looks_.texels.ids) {
            const Texel& texel = capture_.atlas.texels[id];
            const std::size_t i = maps.specular.index(texel.column, texel.row);
            Reflectance& reflectance = truth.reflectance.emplace_back();
            for (std::size_t c = 0; c < 3; ++c) {
                reflectance.diffuse[Eigen::Index(c)] = double(maps.diffuse.data[3 * i + c]);
            }
            reflectance.specular = double(maps.specular.data[i]);
            reflectance.roughness = double(maps.roughness.data[i]);
            truth.is_known.push_back(maps.mask.data[i] > 0 ? 1 : 0);
        }
        return truth;
    }

    // The Cramer-Rao bound of an estimate from the lamps' looks, as the fit itself states it.
    [[nodiscard]] double specular_error(std::size_t texel, const Order& lamps) const {
        const Reflectance& reflectance = truth_.reflectance[texel];
        std::vector<LampTerm> terms;
        for (const std::size_t lamp : lamps) {
            for (const LookTerm& term : looks_.candidates[lamp].of(texel)) {
                terms.push_back(
                    {Rgbf::Constant(term.irradiance), term.theta_r_squared, term.lobe_cosines});
            }
        }
        std::vector<FitRow> rows;
        for (const LampTerm& term : terms) {
            FitRow& row = rows.emplace_back();
            row.lamps = std::span(&term, 1);
            row.irradiance = term.irradiance.cast<double>();
            row.radiance = predict(row, reflectance);
            for (Eigen::Index c = 0; c < 3; ++c) {
                row.weight[c] = 1 / noise_.variance(row.radiance[c]);
            }
        }
        return fit_errors(rows, reflectance).specular;
    }

    ScanOptions scan_;
    SimulatedObject object_;
    Capture capture_;
    PlannedLooks looks_;
    TrueTexels truth_;
    LookNoise noise_;
};

class Planning : public testing::TestWithParam<ObjectKind> {};

TEST_P(Planning, InformationKnowsPsAtMoreTexelsThanRandomOrUniformLamps) {
    const PlannedObject object(GetParam());
    const Order sixteen = object.by_information(16);
    const Order ten(sixteen.begin(), sixteen.begin() + 10);
    const double at_10 = object.share_known(ten);
    const double at_16 = object.share_known(sixteen);
    const double random_10 = object.mean_of_random(10);
    const double random_16 = object.mean_of_random(16);
    const double uniform_10 = object.share_known(object.uniform(10));
    const double uniform_16 = object.share_known(object.uniform(16));
    std::printf("10 lamps: %.4f, random %.4f, uniform %.4f\n", at_10, random_10, uniform_10);
    std::printf("16 lamps: %.4f, random %.4f, uniform %.4f\n", at_16, random_16, uniform_16);
    EXPECT_GE(at_10, kBetter * random_10);
    EXPECT_GE(at_16, kBetter * random_16);
    EXPECT_GE(at_10, kBetter * uniform_10);
    EXPECT_GE(at_16, uniform_16);
}

INSTANTIATE_TEST_SUITE_P(Figurines,
                         Planning,
                         testing::Values(ObjectKind::b, ObjectKind::c),
                         [](const auto& object) {
                             return std::string(object.param == ObjectKind::b ? "B" : "C");
                         });

}  // namespace
}  // namespace patina
