#include "patina/plan/look_table.h"

#include "patina/base/parallel.h"
#include "patina/base/random.h"
#include "patina/reflectance/lobe.h"

#include <algorithm>
#include <numeric>

namespace patina {
namespace {

// Whether the lamps together make a look that counts.
bool is_usable(LampLight lamps, std::size_t i, const TexelView& view, const LookLimits& limits) {
    const auto has_edge = [i](const auto* lamp) { return (*lamp)[i].state == ShadowState::edge; };
    const auto counts = [&](const auto* lamp) { return is_usable((*lamp)[i], view, limits); };
    return std::none_of(lamps.begin(), lamps.end(), has_edge) &&
           std::any_of(lamps.begin(), lamps.end(), counts);
}

LookTerm make_term(const Vec3& normal, const DirectLight& light, const TexelView& view) {
    LookTerm term;
    term.irradiance = light.irradiance.mean();
    term.theta_r_squared = float(mirror_angle_squared(
        normal, light.w_i.cast<double>().normalized(), view.w_v.cast<double>().normalized()));
    term.lobe_cosines = float(lobe_cosines(double(light.cos_i), double(view.cos_v)));
    return term;
}

}  // namespace

PlanTexels sample_texels(const RigView& rig, std::size_t max_count, std::uint64_t seed) {
    const std::vector<TexelId>& seen = rig.seen();
    const std::size_t count = max_count == 0 ? seen.size() : std::min(max_count, seen.size());
    PlanTexels texels;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t first = i * seen.size() / count;
        const std::size_t size = (i + 1) * seen.size() / count - first;
        const double u = Rng(seed, Pass::plan_texels, i).uniform();
        texels.ids.push_back(seen[first + std::size_t(u * double(size))]);
    }
    for (std::size_t camera = 0; camera < rig.capture().description.cameras.size(); ++camera) {
        texels.views.push_back(values_at(texels.ids, rig.views(camera)));
    }
    return texels;
}

LookTable collect_looks(const TexelAtlas& atlas,
                        std::span<const TexelId> texels,
                        LampLight lamps,
                        std::span<const TexelView> views,
                        const LookLimits& limits) {
    // Every row with room for every lamp, then packed.
    std::vector<LookTerm> slots(texels.size() * lamps.size());
    LookTable table;
    table.begin.assign(texels.size() + 1, 0);
    parallel_for(texels.size(), [&](std::size_t i) {
        if (!is_usable(lamps, i, views[i], limits)) return;
        std::uint32_t count = 0;
        for (const auto* lamp : lamps) {
            const DirectLight& light = (*lamp)[i];
            if (light.irradiance.maxCoeff() <= 0) continue;
            LookTerm& term = slots[i * lamps.size() + count];
            term = make_term(atlas.texels[texels[i]].point.normal, light, views[i]);
            term.is_joined = count++ > 0;
        }
        table.begin[i + 1] = count;
    });
    for (std::size_t i = 0; i < texels.size(); ++i) {
        const auto row = slots.begin() + std::ptrdiff_t(i * lamps.size());
        table.terms.insert(table.terms.end(), row, row + std::ptrdiff_t(table.begin[i + 1]));
    }
    std::partial_sum(table.begin.begin(), table.begin.end(), table.begin.begin());
    return table;
}

LookTable join_tables(std::span<const LookTable> tables, std::size_t num_texels) {
    LookTable joined;
    joined.begin.push_back(0);
    for (std::size_t texel = 0; texel < num_texels; ++texel) {
        for (const LookTable& table : tables) {
            const std::span<const LookTerm> row = table.of(texel);
            joined.terms.insert(joined.terms.end(), row.begin(), row.end());
        }
        joined.begin.push_back(std::uint32_t(joined.terms.size()));
    }
    return joined;
}

}  // namespace patina
