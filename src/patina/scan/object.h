// The objects of the virtual scanner, ready to be lit: what the light travels over.
//
// A, B and C are those of the paper's experiments (section 3); V45 and U are concave enough for the
// paper's iteration to diverge (docs/theory.md). docs/objects.md explains them all.
#pragma once

#include "patina/scan/figurines.h"
#include "patina/scan/panels.h"
#include "patina/scene/range_image.h"
#include "patina/transport/surface.h"

#include <optional>
#include <string>
#include <vector>

namespace patina {

enum class ObjectKind { a, b, c, v45, u };

// "A", "B", "C", "V45" or "U"; small letters are understood too. Throws Error.
[[nodiscard]] ObjectKind object_kind_from_name(const std::string& name);

// Dimensions of the two grooves [m].
inline constexpr double kGrooveSide = 0.02;     // V45: from its edge to its opening
inline constexpr double kGrooveLength = 0.6;    // V45
inline constexpr double kChannelWidth = 0.012;  // U; its depth is twice that
inline constexpr double kChannelLength = 0.36;  // U
inline constexpr double kGrooveDiffuse = 0.7;   // Pd of both [-]

// length unit: m. Exactly one of range_frame and panels says how it is handed out.
struct SimulatedObject {
    ObjectKind kind;
    std::string name;                      // "object B, a cat"
    Mesh mesh;                             // finer than what is handed out
    std::vector<Reflectance> reflectance;  // one per vertex, linear over the triangles
    Tracer tracer;
    std::optional<RangeFrame> range_frame;  // B and C: scanned cylindrically
    std::vector<Panel> panels;              // A, V45 and U: a textured mesh
    SignedDistance distance;                // B and C

    [[nodiscard]] Surface surface() const { return {&mesh, &tracer}; }
    [[nodiscard]] ReflectanceField field() const {
        return ReflectanceField::per_vertex(mesh, reflectance);
    }
};

// columns, rows: of the texel domain that the object will be handed out in; they set how fine the
// mesh of B and C is. rows: a multiple of 2 for A and V45, of 5 for U. Throws Error("--texels",
// ...).
[[nodiscard]] SimulatedObject make_object(ObjectKind kind, int columns, int rows);

// The point of the surface at a position in the texel domain (first pixel's centre: (0.5, 0.5)).
// Nothing where the range finder sees none, or outside; the azimuth of a full turn wraps around.
[[nodiscard]] std::optional<SurfacePoint> point_at_pixel(const SimulatedObject& object,
                                                         int columns,
                                                         int rows,
                                                         const Vec2& pixel);

// What the range finder measures there: the distance from the axis [m] of the solid itself, which
// the mesh's facets cut by up to a few micrometres. For B and C.
[[nodiscard]] std::optional<double> range_at_pixel(const SimulatedObject& object,
                                                   int columns,
                                                   int rows,
                                                   const Vec2& pixel);

}  // namespace patina
