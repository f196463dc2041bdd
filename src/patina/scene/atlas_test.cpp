#include "patina/scene/atlas.h"

#include <gtest/gtest.h>

#include "support/scenes.h"
#include <algorithm>
#include <set>
#include <utility>

namespace patina {
namespace {

Mesh mapped_rectangle(Vec2 uv0, Vec2 uv1) {
    Mesh mesh;
    append(mesh, rectangle(Vec3::Zero(), 2 * Vec3::UnitX(), 3 * Vec3::UnitY(), {uv0, uv1}));
    return mesh;
}

// Two plates at a right angle that share an edge in space, with separate charts.
Mesh corner_of_two_charts() {
    Mesh mesh;
    append(mesh, rectangle(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), {{0, 0}, {0.4, 1}}));
    append(mesh, rectangle(Vec3::Zero(), Vec3::UnitY(), Vec3::UnitZ(), {{0.5, 0}, {1, 0.5}}));
    return mesh;
}

double total_area(const TexelAtlas& atlas) {
    double sum = 0;
    for (const Texel& texel : atlas.texels) sum += texel.area;
    return sum;
}

TEST(Atlas, TexelCentersFollowTheConvention) {
    const Mesh mesh = mapped_rectangle({0, 0}, {1, 1});
    const TexelAtlas atlas = build_atlas(mesh, 4, 8);
    ASSERT_EQ(atlas.texels.size(), 32u);
    for (const Texel& texel : atlas.texels) {
        // Row 0 is the top, v = 1; uv is linear in space over the rectangle of 2 x 3.
        EXPECT_NEAR(texel.point.position.x(), 2 * (texel.column + 0.5) / 4, 1e-6);
        EXPECT_NEAR(texel.point.position.y(), 3 * (1 - (texel.row + 0.5) / 8), 1e-6);
        EXPECT_NEAR(texel.area, 6.0 / 32, 1e-9);
        EXPECT_NEAR(texel.point.normal.z(), 1, 1e-12);
    }
}

TEST(Atlas, AreasAddUpWhereChartsEndInsideCells) {
    const Mesh mesh = mapped_rectangle({0.13, 0.21}, {0.87, 0.58});
    const TexelAtlas atlas = build_atlas(mesh, 16, 16);
    EXPECT_NEAR(total_area(atlas), 6.0, 1e-5);
    // Every point of the surface has a texel.
    for (int i = 0; i < 1000; ++i) {
        const float u = float(i % 31) / 31.0f;
        const float v = float(i % 37) / 37.0f * (1 - u);
        EXPECT_NE(atlas.lookup(mesh, std::uint32_t(i % 2), Vec2f(u, v)), kNoTexel);
    }
}

TEST(Atlas, LookupFindsTheTexelOfItsOwnCenter) {
    const Mesh mesh = corner_of_two_charts();
    const TexelAtlas atlas = build_atlas(mesh, 20, 20);
    for (TexelId id = 0; id < atlas.texels.size(); ++id) {
        const SurfacePoint& point = atlas.texels[id].point;
        EXPECT_EQ(atlas.lookup(mesh, point.triangle, point.barycentric), id);
    }
}

TEST(Atlas, SeamsJoinChartsThatMeetInSpace) {
    const Mesh mesh = corner_of_two_charts();
    const TexelAtlas atlas = build_atlas(mesh, 20, 20);
    std::set<std::uint32_t> charts;
    int num_across = 0;
    for (TexelId id = 0; id < atlas.texels.size(); ++id) {
        const Texel& texel = atlas.texels[id];
        charts.insert(texel.chart);
        for (std::uint32_t k = atlas.neighbor_begin[id]; k < atlas.neighbor_begin[id + 1]; ++k) {
            const Texel& other = atlas.texels[atlas.neighbors[k]];
            if (other.chart == texel.chart) continue;
            ++num_across;
            // Both lie at the common edge x = z = 0, within a texel of it (1/8 and 1/10 wide).
            EXPECT_LT(texel.point.position.x() + texel.point.position.z(), 0.13);
            EXPECT_NEAR(texel.point.position.y(), other.point.position.y(), 0.11);
        }
    }
    EXPECT_EQ(charts.size(), 2u);
    // The 20 texels on the long side each have at least one neighbour across, and the reverse.
    EXPECT_GE(num_across, 40);
}

TEST(Atlas, OfManyChartsAtOneEdgeEachMeetsTheFirst) {
    Mesh mesh = corner_of_two_charts();
    append(mesh, rectangle(Vec3::Zero(), -Vec3::UnitX(), Vec3::UnitY(), {{0.5, 0.6}, {1, 1}}));
    const TexelAtlas atlas = build_atlas(mesh, 20, 20);
    std::set<std::pair<std::uint32_t, std::uint32_t>> meetings;
    for (TexelId id = 0; id < atlas.texels.size(); ++id) {
        for (std::uint32_t k = atlas.neighbor_begin[id]; k < atlas.neighbor_begin[id + 1]; ++k) {
            meetings.emplace(atlas.texels[id].chart, atlas.texels[atlas.neighbors[k]].chart);
        }
    }
    const std::set<std::pair<std::uint32_t, std::uint32_t>> expected = {
        {0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 0}, {0, 2}, {2, 0}};
    EXPECT_EQ(meetings, expected);
}

TEST(Atlas, NeighborsAreMutualAndDistinct) {
    const TexelAtlas atlas = build_atlas(corner_of_two_charts(), 20, 20);
    const auto neighbors_of = [&atlas](TexelId id) {
        return std::vector<TexelId>(atlas.neighbors.begin() + atlas.neighbor_begin[id],
                                    atlas.neighbors.begin() + atlas.neighbor_begin[id + 1]);
    };
    for (TexelId id = 0; id < atlas.texels.size(); ++id) {
        const std::vector<TexelId> neighbors = neighbors_of(id);
        EXPECT_TRUE(std::is_sorted(neighbors.begin(), neighbors.end()));
        EXPECT_EQ(std::set<TexelId>(neighbors.begin(), neighbors.end()).size(), neighbors.size());
        for (const TexelId other : neighbors) {
            const std::vector<TexelId> back = neighbors_of(other);
            EXPECT_TRUE(std::binary_search(back.begin(), back.end(), id));
        }
    }
}

}  // namespace
}  // namespace patina
