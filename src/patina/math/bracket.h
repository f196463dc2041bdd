// The search for the lowest point of a cost of one variable, by parabolas.
//
// Based on: Brent. Algorithms for Minimization without Derivatives. 1973, chapter 5; without its
// bookkeeping, for costs that are smooth and dear.
#pragma once

namespace patina {

// Three points of a cost whose middle one is the lowest.
struct Bracket {
    double low, middle, high;
    double cost_low, cost_middle, cost_high;

    // Replaces one end or the middle by the new point.
    void insert(double x, double cost) {
        if (cost < cost_middle) {
            (x < middle ? high : low) = middle;
            (x < middle ? cost_high : cost_low) = cost_middle;
            middle = x;
            cost_middle = cost;
        } else {
            (x < middle ? low : high) = x;
            (x < middle ? cost_low : cost_high) = cost;
        }
    }
    // The vertex of the parabola through the three, or the middle of the larger part where it is
    // useless.
    [[nodiscard]] double next() const {
        const double left = middle - low;
        const double right = high - middle;
        const double rise_left = cost_low - cost_middle;
        const double rise_right = cost_high - cost_middle;
        const double denominator = 2 * (left * rise_right + right * rise_left);
        if (denominator > 0) {
            const double x =
                middle + (right * right * rise_left - left * left * rise_right) / denominator;
            const double margin = 0.01 * (high - low);
            if (x > low + margin && x < high - margin) return x;
        }
        return left > right ? middle - 0.4 * left : middle + 0.4 * right;
    }
};

}  // namespace patina
