#include "patina/transport/disc_estimator.h"

#include "patina/base/check.h"
#include "patina/base/parallel.h"

#include <nanoflann.hpp>

#include <algorithm>
#include <limits>

namespace patina {
namespace {

// Cosine between two normals above which surfaces count as one; as in the ratio kernel.
constexpr float kMinNormalCosine = 0.7f;
constexpr std::size_t kPhotonsPerLeaf = 10;
// Queries handed to a thread at once, which share one buffer of neighbours.
constexpr std::size_t kQueriesPerBlock = 256;

// The photons as nanoflann wants to see them.
struct PhotonCloud {
    std::span<const Vec3f> positions;

    [[nodiscard]] std::size_t kdtree_get_point_count() const { return positions.size(); }
    [[nodiscard]] float kdtree_get_pt(std::size_t index, std::size_t axis) const {
        return positions[index][Eigen::Index(axis)];
    }
    template <typename Box>
    bool kdtree_get_bbox(Box& /*box*/) const {
        return false;  // nanoflann finds it
    }
};

using Tree = nanoflann::
    KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, PhotonCloud>, PhotonCloud, 3>;

struct Neighbor {
    float distance_squared = 0;  // [length^2]
    std::size_t photon = 0;
    bool operator<(const Neighbor& other) const {
        return distance_squared != other.distance_squared
                   ? distance_squared < other.distance_squared
                   : photon < other.photon;
    }
};

// Collects the nearest photons that pass the filter of normals, a heap with the farthest on top.
// Its interface is nanoflann's.
class NeighborSet {
  public:
    using DistanceType = float;

    NeighborSet(std::span<const Vec3f> photon_normals, std::size_t capacity)
        : photon_normals_(photon_normals), capacity_(capacity) {
        heap_.reserve(capacity);
    }

    // normal: of the query; ignored when there are no normals of photons.
    void restart(const Vec3f& normal) {
        normal_ = normal;
        heap_.clear();
    }
    // Nearest first; ends the search.
    [[nodiscard]] std::span<const Neighbor> sorted() {
        std::sort_heap(heap_.begin(), heap_.end());
        return heap_;
    }

    bool addPoint(float distance_squared, std::size_t photon) {
        if (!photon_normals_.empty() && photon_normals_[photon].dot(normal_) < kMinNormalCosine) {
            return true;
        }
        const Neighbor neighbor{distance_squared, photon};
        if (full()) {
            if (!(neighbor < heap_.front())) return true;
            std::pop_heap(heap_.begin(), heap_.end());
            heap_.back() = neighbor;
        } else {
            heap_.push_back(neighbor);
        }
        std::push_heap(heap_.begin(), heap_.end());
        return true;
    }
    [[nodiscard]] float worstDist() const {
        return full() ? heap_.front().distance_squared : std::numeric_limits<float>::max();
    }
    [[nodiscard]] std::size_t size() const { return heap_.size(); }
    [[nodiscard]] bool full() const { return heap_.size() == capacity_; }

  private:
    std::span<const Vec3f> photon_normals_;
    std::size_t capacity_;
    Vec3f normal_ = Vec3f::UnitZ();
    std::vector<Neighbor> heap_;
};

Rgb disc_of(std::span<const Neighbor> neighbors, std::span<const Rgbf> powers, bool correct_count) {
    if (neighbors.size() < 2 || neighbors.back().distance_squared <= 0) return Rgb::Zero();
    Rgb power = Rgb::Zero();
    for (const Neighbor& neighbor : neighbors) power += powers[neighbor.photon].cast<double>();
    const auto count = double(neighbors.size());
    if (correct_count) power *= (count - 1) / count;
    return power / (kPi * double(neighbors.back().distance_squared));
}

}  // namespace

std::vector<Rgbf> disc_irradiance(const DiscPhotons& photons,
                                  const DiscQueries& queries,
                                  const DiscOptions& options) {
    PATINA_CHECK_EQ(photons.powers.size(), photons.positions.size());
    PATINA_CHECK_LE(2, options.neighbors);
    if (options.normal_filter) {
        PATINA_CHECK_EQ(photons.normals.size(), photons.positions.size());
        PATINA_CHECK_EQ(queries.normals.size(), queries.positions.size());
    }
    std::vector<Rgbf> irradiance(queries.positions.size(), Rgbf::Zero());
    if (photons.positions.empty()) return irradiance;
    const PhotonCloud cloud{photons.positions};
    const Tree tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(kPhotonsPerLeaf));
    const std::span<const Vec3f> filter =
        options.normal_filter ? photons.normals : std::span<const Vec3f>();
    const std::size_t capacity = std::min(std::size_t(options.neighbors), photons.positions.size());
    parallel_blocks(irradiance.size(), kQueriesPerBlock, [&](std::size_t begin, std::size_t end) {
        NeighborSet nearest(filter, capacity);
        for (std::size_t i = begin; i < end; ++i) {
            nearest.restart(options.normal_filter ? queries.normals[i] : Vec3f::UnitZ());
            tree.findNeighbors(nearest, queries.positions[i].data(), {});
            irradiance[i] =
                disc_of(nearest.sorted(), photons.powers, options.correct_count).cast<float>();
        }
    });
    return irradiance;
}

std::vector<IndirectIrradiance> disc_indirect_irradiance(const PhotonPaths& paths,
                                                         std::span<const Rgbf> power,
                                                         const TexelAtlas& atlas,
                                                         const DiscOptions& options) {
    PATINA_CHECK_EQ(paths.arrival_position.size(), paths.arrival_half.size());
    PATINA_CHECK_EQ(power.size(), paths.arrival_half.size());
    DiscOptions half_options = options;
    half_options.neighbors = std::max(2, options.neighbors / 2);
    half_options.normal_filter = false;
    std::vector<Vec3f> texels(atlas.texels.size());
    for (std::size_t i = 0; i < texels.size(); ++i) {
        texels[i] = atlas.texels[i].point.position.cast<float>();
    }
    std::vector<IndirectIrradiance> result(texels.size());
    for (std::uint8_t half = 0; half < 2; ++half) {
        std::vector<Vec3f> positions;
        std::vector<Rgbf> powers;
        for (std::size_t k = 0; k < paths.arrival_half.size(); ++k) {
            if (paths.arrival_half[k] != half) continue;
            positions.push_back(paths.arrival_position[k]);
            // Half of the photons carries half of the power.
            powers.push_back(2 * power[k]);
        }
        const std::vector<Rgbf> irradiance =
            disc_irradiance({positions, powers, {}}, {texels, {}}, half_options);
        for (std::size_t i = 0; i < result.size(); ++i) result[i].halves[half] = irradiance[i];
    }
    return result;
}

}  // namespace patina
