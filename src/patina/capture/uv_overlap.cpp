// Based on: Gottschalk. Separating axis theorem. Technical Report TR96-024, UNC Chapel Hill, 1996.
#include "patina/capture/uv_overlap.h"

#include "patina/base/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace patina {
namespace {

using UvTriangle = std::array<Vec2, 3>;

constexpr std::uint32_t kNoTriangle = std::numeric_limits<std::uint32_t>::max();
// Triangles per leaf of the tree; a matter of speed alone.
constexpr std::size_t kLeafSize = 4;
// Triangles between two looks at whether there is a fault, and handed to a thread at once; a matter
// of speed alone.
constexpr std::size_t kBlockSize = 1024;
constexpr std::size_t kGrain = 16;

struct Box {
    Vec2 low = Vec2::Constant(std::numeric_limits<double>::infinity());
    Vec2 high = Vec2::Constant(-std::numeric_limits<double>::infinity());

    void add(const Box& other) {
        low = low.cwiseMin(other.low);
        high = high.cwiseMax(other.high);
    }
    [[nodiscard]] bool overlaps(const Box& other, double tolerance) const {
        const Vec2 depth = high.cwiseMin(other.high) - low.cwiseMax(other.low);
        return depth.minCoeff() > tolerance;
    }
};

UvTriangle uv_triangle(const Mesh& mesh, std::size_t triangle) {
    const Triangle& corners = mesh.triangles[triangle];
    return {mesh.uvs[corners[0]].cast<double>(),
            mesh.uvs[corners[1]].cast<double>(),
            mesh.uvs[corners[2]].cast<double>()};
}

Box box_of(const UvTriangle& triangle) {
    Box box;
    for (const Vec2& corner : triangle) box.add({corner, corner});
    return box;
}

struct Interval {
    double low = std::numeric_limits<double>::infinity();
    double high = -std::numeric_limits<double>::infinity();
};

Interval project(const UvTriangle& triangle, const Vec2& axis) {
    Interval interval;
    for (const Vec2& corner : triangle) {
        const double along = axis.dot(corner);
        interval.low = std::min(interval.low, along);
        interval.high = std::max(interval.high, along);
    }
    return interval;
}

// Whether no edge of `a` has `b` on its other side.
bool no_edge_separates(const UvTriangle& a, const UvTriangle& b, double tolerance) {
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec2 edge = a[(i + 1) % 3] - a[i];
        const Vec2 normal = Vec2(-edge.y(), edge.x()).normalized();
        const Interval of_a = project(a, normal);
        const Interval of_b = project(b, normal);
        const double depth = std::min(of_a.high, of_b.high) - std::max(of_a.low, of_b.low);
        if (depth <= tolerance) return false;
    }
    return true;
}

bool triangles_overlap(const UvTriangle& a, const UvTriangle& b, double tolerance) {
    return no_edge_separates(a, b, tolerance) && no_edge_separates(b, a, tolerance);
}

// A tree of boxes over triangles sorted so that every node is a range of `order`; each range is
// halved at the median of its wider side, down to kLeafSize.
class BoxTree {
  public:
    explicit BoxTree(const std::vector<Box>& boxes) : boxes_(boxes), order_(boxes.size()) {
        std::iota(order_.begin(), order_.end(), 0U);
        nodes_.reserve(2 * boxes.size());
        build(0, order_.size());
    }

    // Calls visit(triangle) for every triangle whose box overlaps `box`.
    template <typename Visit>
    void visit_overlapping(const Box& box, double tolerance, const Visit& visit) const {
        visit_node(0, box, tolerance, visit);
    }

  private:
    struct Node {
        Box box;
        std::size_t begin = 0;
        std::size_t end = 0;
        std::size_t right = 0;  // the left child follows its parent; 0: a leaf
    };

    void build(std::size_t begin, std::size_t end) {
        const std::size_t index = nodes_.size();
        nodes_.push_back({Box(), begin, end, 0});
        Box centers;
        Box box;
        for (std::size_t i = begin; i < end; ++i) {
            const Box& item = boxes_[order_[i]];
            box.add(item);
            centers.add({center(item), center(item)});
        }
        nodes_[index].box = box;
        if (end - begin <= kLeafSize) return;
        const Vec2 extent = centers.high - centers.low;
        const int axis = extent.x() >= extent.y() ? 0 : 1;
        const std::size_t middle = begin + (end - begin) / 2;
        const auto at = [this](std::size_t i) { return order_.begin() + std::ptrdiff_t(i); };
        std::nth_element(at(begin), at(middle), at(end), [&](std::uint32_t a, std::uint32_t b) {
            return center(boxes_[a])[axis] < center(boxes_[b])[axis];
        });
        build(begin, middle);
        nodes_[index].right = nodes_.size();
        build(middle, end);
    }

    template <typename Visit>
    void visit_node(std::size_t index, const Box& box, double tolerance, const Visit& visit) const {
        const Node& node = nodes_[index];
        if (!node.box.overlaps(box, tolerance)) return;
        if (node.right == 0) {
            for (std::size_t i = node.begin; i < node.end; ++i) {
                if (boxes_[order_[i]].overlaps(box, tolerance)) visit(order_[i]);
            }
            return;
        }
        visit_node(index + 1, box, tolerance, visit);
        visit_node(node.right, box, tolerance, visit);
    }

    [[nodiscard]] static Vec2 center(const Box& box) { return 0.5 * (box.low + box.high); }

    const std::vector<Box>& boxes_;
    std::vector<std::uint32_t> order_;
    std::vector<Node> nodes_;
};

}  // namespace

std::optional<UvOverlap> find_uv_overlap(const Mesh& mesh, double tolerance) {
    const std::size_t num_triangles = mesh.triangles.size();
    std::vector<Box> boxes(num_triangles);
    parallel_for(num_triangles, [&](std::size_t i) { boxes[i] = box_of(uv_triangle(mesh, i)); });
    const BoxTree tree(boxes);
    // The lowest partner above a triangle.
    const auto find_partner = [&](std::size_t i) {
        std::uint32_t partner = kNoTriangle;
        const UvTriangle triangle = uv_triangle(mesh, i);
        tree.visit_overlapping(boxes[i], tolerance, [&](std::uint32_t other) {
            if (other <= i || other >= partner) return;
            if (triangles_overlap(triangle, uv_triangle(mesh, other), tolerance)) partner = other;
        });
        return partner;
    };
    // In blocks, the first fault ends the search: a mesh all of whose triangles lie on each other
    // would take the square of their number.
    std::vector<std::uint32_t> partners(std::min(kBlockSize, num_triangles));
    for (std::size_t begin = 0; begin < num_triangles; begin += kBlockSize) {
        const std::size_t size = std::min(kBlockSize, num_triangles - begin);
        parallel_for(
            size, [&](std::size_t i) { partners[i] = find_partner(begin + i); }, kGrain);
        for (std::size_t i = 0; i < size; ++i) {
            if (partners[i] != kNoTriangle) return UvOverlap{std::uint32_t(begin + i), partners[i]};
        }
    }
    return std::nullopt;
}

}  // namespace patina
