#include "patina/export/lamp_map.h"

#include "patina/export/html_page.h"
#include "patina/export/svg_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace patina {
namespace {

constexpr double kWidth = 400;
constexpr double kHeight = 280;
constexpr double kInset = 42;
constexpr double kRadius = 9;      // of a chosen lamp [pixels]
constexpr double kRadiusFree = 4;  // of the others [pixels]
constexpr double kPlaneAngle = radians(60);
// Directions whose mean is shorter than this lie all around the object.
constexpr double kMinMean = 0.1;

struct FlatMap {
    std::vector<Vec2> places;  // one per lamp [length or degrees]
    bool is_angular = false;
};

FlatMap flatten(const SelectionReport& selection) {
    std::vector<Vec3> directions;
    Vec3 sum = Vec3::Zero();
    bool all_points = true;
    for (const Light& lamp : selection.lamps) {
        directions.push_back(direction_to(lamp, selection.object_center));
        sum += directions.back();
        all_points = all_points && lamp.type == LightType::point;
    }
    const bool is_around = sum.norm() < kMinMean * double(directions.size());
    const Vec3 middle = is_around ? Vec3(Vec3::UnitY()) : Vec3(sum.normalized());
    const Vec3 up_hint = std::abs(middle.y()) < 0.99 ? Vec3(Vec3::UnitY()) : Vec3(-Vec3::UnitZ());
    // Looking along `middle`, up stays up and this is to the right.
    const Vec3 right = middle.cross(up_hint).normalized();
    const Vec3 up = right.cross(middle);

    FlatMap map;
    map.is_angular = !all_points || is_around ||
                     std::any_of(directions.begin(), directions.end(), [&](const Vec3& w) {
                         return w.dot(middle) < std::cos(kPlaneAngle);
                     });
    for (std::size_t i = 0; i < directions.size(); ++i) {
        if (map.is_angular) {
            const Vec2 across(directions[i].dot(right), directions[i].dot(up));
            const double angle =
                degrees(std::acos(std::clamp(directions[i].dot(middle), -1.0, 1.0)));
            map.places.push_back(across.norm() > 0 ? Vec2(angle * across.normalized())
                                                   : Vec2(Vec2::Zero()));
        } else {
            const Vec3 offset = selection.lamps[i].position - selection.object_center;
            map.places.emplace_back(offset.dot(right), offset.dot(up));
        }
    }
    return map;
}

// Keeps the aspect ratio: one scale for both axes.
struct Frame {
    Vec2 middle = Vec2::Zero();
    double pixels_per_unit = 1;

    [[nodiscard]] Vec2 pixel(const Vec2& place) const {
        return {kWidth / 2 + (place.x() - middle.x()) * pixels_per_unit,
                kHeight / 2 - (place.y() - middle.y()) * pixels_per_unit};
    }
};

Frame fit_frame(const std::vector<Vec2>& places) {
    Vec2 low = places.front();
    Vec2 high = places.front();
    for (const Vec2& place : places) {
        low = low.cwiseMin(place);
        high = high.cwiseMax(place);
    }
    Frame frame;
    frame.middle = 0.5 * (low + high);
    const Vec2 size = (high - low).cwiseMax(1e-9);
    frame.pixels_per_unit =
        std::min((kWidth - 2 * kInset) / size.x(), (kHeight - 2 * kInset) / size.y());
    return frame;
}

// A bar of a round length at the lower left.
std::string scale_bar(const Frame& frame, const std::string& unit) {
    const std::vector<double> ticks = linear_ticks(0, 0.3 * kWidth / frame.pixels_per_unit, 2);
    const double length = ticks.back();
    const double x2 = kInset + length * frame.pixels_per_unit;
    return fmt::format(
        "<line class=\"frame\" x1=\"{0:.1f}\" y1=\"{2:.1f}\" x2=\"{1:.1f}\" y2=\"{2:.1f}\"/>"
        "<text class=\"tick\" x=\"{3:.1f}\" y=\"{4:.1f}\">{5}</text>",
        kInset,
        x2,
        kHeight - 8,
        x2 + 6,
        kHeight - 4,
        escape_html(tick_labels({0, length}).back() + " " + unit));
}

std::string draw_lamp(const Vec2& at, const Light& lamp, std::ptrdiff_t order, bool for_diffuse) {
    const std::string title = "<title>" + escape_html(lamp.id) + "</title>";
    if (order < 0) {
        return fmt::format(
            "<circle class=\"lamp\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\">{}</circle>",
            at.x(),
            at.y(),
            kRadiusFree,
            title);
    }
    return fmt::format(
        "<g><circle cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"{2}\" style=\"fill:var(--series-{3})\"/>"
        "<text class=\"inverse\" x=\"{0:.1f}\" y=\"{4:.1f}\" "
        "text-anchor=\"middle\">{5}</text>{6}</g>",
        at.x(),
        at.y(),
        kRadius,
        for_diffuse ? 2 : 1,
        at.y() + 3.5,
        order + 1,
        title);
}

}  // namespace

std::string lamp_map(const SelectionReport& selection) {
    if (selection.lamps.empty()) return "";
    const FlatMap map = flatten(selection);
    const Frame frame = fit_frame(map.places);
    const auto order_in = [](const std::vector<std::size_t>& list, std::size_t lamp) {
        const auto found = std::find(list.begin(), list.end(), lamp);
        return found == list.end() ? std::ptrdiff_t(-1) : found - list.begin();
    };
    std::string svg = fmt::format(
        "<svg width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" role=\"img\" "
        "aria-label=\"Lamp positions\"><text class=\"title\" x=\"{2}\" y=\"16\">Lamp "
        "positions</text>",
        kWidth,
        kHeight,
        kInset - kRadius);
    for (std::size_t i = 0; i < selection.lamps.size(); ++i) {
        const std::ptrdiff_t order = order_in(selection.chosen, i);
        if (order < 0 && order_in(selection.candidates, i) < 0) continue;
        svg += draw_lamp(frame.pixel(map.places[i]),
                         selection.lamps[i],
                         order,
                         order_in(selection.chosen_for_diffuse, i) >= 0);
    }
    svg += scale_bar(frame, map.is_angular ? "degrees" : selection.length_unit);
    return svg + "</svg>\n";
}

}  // namespace patina
