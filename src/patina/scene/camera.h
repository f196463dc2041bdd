// Cameras of a capture: pinhole, orthographic, and registered (the image lies in the texel domain).
#pragma once

#include "patina/math/types.h"

#include <array>
#include <optional>
#include <string>

namespace patina {

enum class CameraModel { pinhole, orthographic, registered };
// scanner: turns with a rotating range finder; positions are given for azimuth 0.
enum class FrameOfReference { world, scanner };

struct Ray {
    Vec3 origin = Vec3::Zero();
    Vec3 direction = Vec3::UnitZ();  // unit
};

struct Camera {
    std::string id;
    CameraModel model = CameraModel::pinhole;
    int width = 0;   // [pixels]; for registered cameras the size of the texel domain
    int height = 0;  // [pixels]
    double fx = 0;   // [pixels], pinhole
    double fy = 0;
    double cx = 0;
    double cy = 0;
    std::array<double, 5> distortion = {0, 0, 0, 0, 0};  // OpenCV's k1 k2 p1 p2 k3
    double pixel_size = 0;                               // [length], orthographic
    RigidTransform world_from_camera;                    // x right, y down, z forward
    Vec3 position = Vec3::Zero();                        // [length], registered
    FrameOfReference frame = FrameOfReference::world;

    // Position in the image (top-left corner (0,0), first pixel's centre (0.5,0.5)); nothing when
    // the point is not in front of a pinhole camera or lies where the distortion folds over.
    // Orthographic cameras always answer, as their depth images may hold any z. The result may lie
    // outside the image. Not for registered cameras.
    [[nodiscard]] std::optional<Vec2> project(const Vec3& p_world) const;
    // The ray through an image position, from the camera. Where distortion brings no point to this
    // position, the ray at the rim of what it can show. Not for registered cameras.
    [[nodiscard]] Ray ray(const Vec2& pixel) const;
    // Unit direction from p towards the camera. azimuth: of p's column [rad], for scanner frames.
    [[nodiscard]] Vec3 direction_from(const Vec3& p_world, double azimuth) const;
    // Distance from p to the camera's centre [length]; for orthographic ones the depth of p, which
    // is negative behind their plane.
    [[nodiscard]] double distance_from(const Vec3& p_world, double azimuth) const;
    // z in the camera's frame [length]. Not for registered cameras.
    [[nodiscard]] double depth_of(const Vec3& p_world) const;
};

}  // namespace patina
