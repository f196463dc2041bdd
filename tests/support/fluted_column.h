// A scanned object with deep grooves: what lights them depends on where the lamp stands.
#pragma once

#include "patina/math/warp.h"
#include "patina/scene/atlas.h"

#include <cmath>
#include <vector>

namespace patina {

// A fluted column about the y axis, radius 1 + 0.4 cos(3 longitude), height 1, one column of texels
// for each facet.
struct FlutedColumn {
    static constexpr int kColumns = 126;
    static constexpr int kRows = 20;

    [[nodiscard]] static Mesh mesh() {
        Mesh mesh;
        for (int row = 0; row <= 1; ++row) {
            for (int column = 0; column <= kColumns; ++column) {
                const double longitude = 2 * kPi * (column % kColumns) / kColumns;
                const double radius = 1 + 0.4 * std::cos(3 * longitude);
                mesh.positions.push_back(
                    rotate_about_y(longitude, Vec3(0, row, radius)).cast<float>());
                mesh.normals.push_back(Vec3f::Zero());
                mesh.uvs.emplace_back(float(column) / kColumns, float(row));
            }
        }
        for (std::uint32_t i = 0; i < kColumns; ++i) {
            const std::uint32_t above = i + kColumns + 1;
            mesh.triangles.push_back({i, i + 1, above + 1});
            mesh.triangles.push_back({i, above + 1, above});
        }
        return mesh;
    }
    // Each column is seen when its middle is in front of the scanner.
    [[nodiscard]] static TexelAtlas atlas(const Mesh& mesh) {
        TexelAtlas atlas = build_atlas(mesh, kColumns, kRows);
        for (Texel& texel : atlas.texels) texel.azimuth = 2 * kPi * (texel.column + 0.5) / kColumns;
        return atlas;
    }
    // Texels of the columns from begin to end - 1 of each third: flutes are deepest about
    // column 21.
    [[nodiscard]] static std::vector<TexelId> flute(const TexelAtlas& atlas, int begin, int end) {
        std::vector<TexelId> texels;
        for (std::size_t i = 0; i < atlas.texels.size(); ++i) {
            const int column = atlas.texels[i].column % (kColumns / 3);
            if (column >= begin && column < end) texels.push_back(TexelId(i));
        }
        return texels;
    }
};

}  // namespace patina
