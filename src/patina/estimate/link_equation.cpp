#include "patina/estimate/link_equation.h"

#include "patina/base/check.h"
#include "patina/base/parallel.h"
#include "patina/estimate/link_levels.h"
#include "patina/math/types.h"

namespace patina {
namespace {

class Solver {
  public:
    Solver(const TexelAtlas& atlas,
           std::span<const float> link,
           const LinkEquation& equation,
           std::vector<double>& values)
        : atlas_(atlas),
          link_(link),
          equation_(equation),
          values_(values),
          levels_(atlas, link, equation),
          direction_(values.size(), 0.0),
          residual_(equation.unknown.size()),
          image_(equation.unknown.size()) {}

    int run(const LinkSolverOptions& options) {
        const double right_squared = ordered_reduce(
            size(), 0.0, [&](std::size_t row) { return square(equation_.right[row]); });
        // Nothing drives it, so that no residual is small beside the right side: it is 0.
        if (!(right_squared > 0)) {
            for (const TexelId texel : equation_.unknown) values_[texel] = 0;
            return 0;
        }
        const double goal = square(options.tolerance) * right_squared;
        double residual_squared = start();
        double scaled = correct();
        turn(0);
        int steps = 0;
        while (residual_squared > goal && steps < options.max_steps) {
            const double curvature = ordered_reduce(size(), 0.0, [&](std::size_t row) {
                image_[row] = image_of(direction_, row);
                return direction_[equation_.unknown[row]] * image_[row];
            });
            if (!(curvature > 0)) return steps;  // the direction has shrunk to nothing
            const double before = scaled;
            residual_squared = advance(before / curvature);
            scaled = correct();
            turn(scaled / before);
            ++steps;
        }
        return steps;
    }

  private:
    [[nodiscard]] std::size_t size() const { return equation_.unknown.size(); }

    [[nodiscard]] double image_of(const std::vector<double>& of, std::size_t row) const {
        const TexelId texel = equation_.unknown[row];
        double sum = equation_.diagonal[row] * of[texel];
        for (std::uint32_t k = atlas_.neighbor_begin[texel]; k < atlas_.neighbor_begin[texel + 1];
             ++k) {
            sum -= double(link_[k]) * of[atlas_.neighbors[k]];
        }
        return sum;
    }

    // Returns the squared residual, as advance().
    double start() {
        return ordered_reduce(size(), 0.0, [&](std::size_t row) {
            residual_[row] = equation_.right[row] - image_of(values_, row);
            return square(residual_[row]);
        });
    }

    // Moves along the direction.
    double advance(double step) {
        return ordered_reduce(size(), 0.0, [&](std::size_t row) {
            const TexelId texel = equation_.unknown[row];
            values_[texel] += step * direction_[texel];
            residual_[row] -= step * image_[row];
            return square(residual_[row]);
        });
    }

    // The preconditioned residual, in the place of the image; returns its product with the
    // residual.
    double correct() {
        levels_.load(residual_);
        return ordered_reduce(size(), 0.0, [&](std::size_t row) {
            image_[row] = levels_.correction(row, residual_[row]);
            return image_[row] * residual_[row];
        });
    }

    // The next direction: the preconditioned residual, and so much of the last one.
    void turn(double share) {
        parallel_for(
            size(),
            [&](std::size_t row) {
                const TexelId texel = equation_.unknown[row];
                direction_[texel] = image_[row] + share * direction_[texel];
            },
            kParallelBlock);
    }

    const TexelAtlas& atlas_;
    std::span<const float> link_;
    const LinkEquation& equation_;
    std::vector<double>& values_;  // per texel; 0 where known
    LinkLevels levels_;
    std::vector<double> direction_;  // per texel; 0 where known
    std::vector<double> residual_;   // per row
    std::vector<double> image_;      // of the direction or the residual, per row
};

}  // namespace

int solve_links(const TexelAtlas& atlas,
                std::span<const float> link,
                const LinkEquation& equation,
                const LinkSolverOptions& options,
                std::vector<double>& values) {
    PATINA_CHECK_EQ(values.size(), atlas.texels.size());
    PATINA_CHECK_EQ(link.size(), atlas.neighbors.size());
    PATINA_CHECK_EQ(equation.diagonal.size(), equation.unknown.size());
    PATINA_CHECK_EQ(equation.right.size(), equation.unknown.size());
    std::vector<double> start(values.size(), 0.0);
    for (const TexelId texel : equation.unknown) start[texel] = values[texel];
    values = std::move(start);
    return Solver(atlas, link, equation, values).run(options);
}

}  // namespace patina
