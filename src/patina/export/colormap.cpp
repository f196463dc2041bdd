#include "patina/export/colormap.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace patina {
namespace {

// Lightness, chroma and hue of OKLab; hue in degrees.
struct Lch {
    double lightness = 0;
    double chroma = 0;
    double hue = 0;
};

// Chroma stays inside the sRGB gamut for all colours below, which a test checks.
Rgb srgb_from_lch(const Lch& color) {
    const double a = color.chroma * std::cos(radians(color.hue));
    const double b = color.chroma * std::sin(radians(color.hue));
    const auto cube = [](double v) { return v * v * v; };
    const double l = cube(color.lightness + 0.3963377774 * a + 0.2158037573 * b);
    const double m = cube(color.lightness - 0.1055613458 * a - 0.0638541728 * b);
    const double s = cube(color.lightness - 0.0894841775 * a - 1.2914855480 * b);
    return {srgb_from_linear(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
            srgb_from_linear(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
            srgb_from_linear(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s)};
}

double linear_from_srgb(double v) {
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

}  // namespace

double srgb_from_linear(double linear) {
    const double v = std::clamp(linear, 0.0, 1.0);
    return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
}

double perceived_lightness(const Rgb& srgb) {
    const double r = linear_from_srgb(srgb[0]);
    const double g = linear_from_srgb(srgb[1]);
    const double b = linear_from_srgb(srgb[2]);
    const double l = std::cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
    const double m = std::cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
    const double s = std::cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
    return 0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s;
}

Rgb sequential_color(double t) {
    const double u = std::clamp(t, 0.0, 1.0);
    return srgb_from_lch({0.26 + 0.66 * u, 0.093 + 0.2 * square(u - 0.45), 305 - 200 * u});
}

Rgb diverging_color(double t) {
    const double s = std::clamp(t, -1.0, 1.0);
    const double size = std::abs(s);
    return srgb_from_lch({0.96 - 0.52 * size, 0.135 * size, s < 0 ? 255.0 : 40.0});
}

Rgb status_color(int status) {
    static const std::array<Rgb, 4> kColors = {no_value_color(),
                                               srgb_from_lch({0.56, 0.09, 195}),
                                               srgb_from_lch({0.80, 0.12, 85}),
                                               srgb_from_lch({0.42, 0.12, 20})};
    return kColors[std::size_t(std::clamp(status, 0, 3))];
}

Rgb lobe_reason_color(LobeReason reason) {
    static const std::array<Rgb, kLobeReasons.size()> kColors = {no_value_color(),
                                                                 status_color(1),
                                                                 srgb_from_lch({0.74, 0.07, 195}),
                                                                 srgb_from_lch({0.83, 0.12, 85}),
                                                                 srgb_from_lch({0.42, 0.12, 20}),
                                                                 srgb_from_lch({0.65, 0.12, 350}),
                                                                 srgb_from_lch({0.30, 0.10, 265}),
                                                                 srgb_from_lch({0.92, 0.03, 100}),
                                                                 srgb_from_lch({0.18, 0.01, 265})};
    return kColors[std::size_t(reason)];
}

Rgb no_value_color() { return Rgb::Constant(0.5); }

}  // namespace patina
