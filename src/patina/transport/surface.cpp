#include "patina/transport/surface.h"

#include "patina/base/check.h"

namespace patina {

ReflectanceField ReflectanceField::per_vertex(const Mesh& mesh,
                                              std::span<const Reflectance> vertices) {
    PATINA_CHECK_EQ(vertices.size(), mesh.positions.size());
    ReflectanceField field;
    field.mesh_ = &mesh;
    field.values_ = vertices;
    return field;
}

ReflectanceField ReflectanceField::per_texel(const Mesh& mesh,
                                             const TexelAtlas& atlas,
                                             std::span<const Reflectance> texels) {
    PATINA_CHECK_EQ(texels.size(), atlas.texels.size());
    ReflectanceField field;
    field.mesh_ = &mesh;
    field.atlas_ = &atlas;
    field.values_ = texels;
    return field;
}

Reflectance ReflectanceField::at(std::uint32_t triangle, const Vec2f& barycentric) const {
    if (atlas_ != nullptr) {
        const TexelId texel = atlas_->lookup(*mesh_, triangle, barycentric);
        return texel == kNoTexel ? Reflectance{} : values_[texel];
    }
    const Triangle& corners = mesh_->triangles[triangle];
    const Reflectance& r0 = values_[corners[0]];
    const Reflectance& r1 = values_[corners[1]];
    const Reflectance& r2 = values_[corners[2]];
    const double u = double(barycentric.x());
    const double v = double(barycentric.y());
    const double w = 1 - u - v;
    return {w * r0.diffuse + u * r1.diffuse + v * r2.diffuse,
            w * r0.specular + u * r1.specular + v * r2.specular,
            w * r0.roughness + u * r1.roughness + v * r2.roughness};
}

bool is_lit(const Surface& surface, const SurfacePoint& point, const LightSample& light) {
    if (!faces(point, light.w_i)) return false;
    const Vec3 origin = surface.tracer->offset(point, light.w_i);
    return !surface.tracer->occluded(origin, light.w_i, light.distance);
}

Rgb direct_irradiance(const Surface& surface,
                      std::span<const Light> lights,
                      double azimuth,
                      const SurfacePoint& point) {
    Rgb sum = Rgb::Zero();
    for (const Light& light : lights) {
        const LightSample sample = sample_light(light, point.position, azimuth);
        if (!(sample.irradiance > 0).any() || !is_lit(surface, point, sample)) continue;
        sum += sample.irradiance * point.normal.dot(sample.w_i);
    }
    return sum;
}

Rgb direct_radiance(const Surface& surface,
                    const Reflectance& reflectance,
                    std::span<const Light> lights,
                    double azimuth,
                    const SurfacePoint& point,
                    const Vec3& w_o) {
    Rgb sum = Rgb::Zero();
    if (!faces(point, w_o)) return sum;
    for (const Light& light : lights) {
        const LightSample sample = sample_light(light, point.position, azimuth);
        if (!(sample.irradiance > 0).any() || !is_lit(surface, point, sample)) continue;
        sum += sample.irradiance * point.normal.dot(sample.w_i) *
               evaluate(reflectance, point.normal, sample.w_i, w_o);
    }
    return sum;
}

}  // namespace patina
