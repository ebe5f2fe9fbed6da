// SPDX-License-Identifier: Apache-2.0
#include "core/integrators/vertex.hpp"

#include "core/integrators/shading_normal.hpp"
#include "core/materials/blend.hpp"
#include "core/materials/bump_map.hpp"
#include "core/materials/normal_map.hpp"
#include "core/sampling/hash.hpp"

namespace tessera::core::integrators {
namespace {

// A number in [0, 1) that depends on every bit of the vectors.
float hashed_number(Vec3 a, Vec3 b) {
  std::uint64_t bits = 0;
  for (const float value : {a.x, a.y, a.z, b.x, b.y, b.z}) bits = sampling::hash(bits, as_bits(value));
  return sampling::unit_float(static_cast<std::uint32_t>(bits >> 32));
}

}  // namespace

const Material& scatterer_of(const Scene& scene, const Hit& hit, const SurfacePoint& surface, Vec3 wo) {
  const Material& material = scene.material_of(hit);
  if (!std::holds_alternative<Blend>(material.model)) return material;
  return scatterer_at(material, scene.materials(), scene.textures(), texture_point_at(scene, hit, surface),
                      meeting_cosine(surface, wo), hashed_number(surface.position, wo),
                      is_behind(surface, wo));
}

Tangents image_tangents(const Scene& scene, const Texture& map, const Hit& hit, const SurfacePoint& surface) {
  if (const auto of_vertices = scene.primitives().vertex_tangents(hit, surface)) return *of_vertices;
  if (!map.is_sheared()) {
    const auto [along_u, along_v] = scene.primitives().tangents(hit, surface, map.uv_set);
    return {along_image(along_u, map.scale.x), along_image(along_v, map.scale.y)};
  }
  const auto [dp_du, dp_dv] = scene.primitives().uv_derivatives(hit, surface, map.uv_set);
  // The inverse of the map from the surface's coordinates to the image's, but for the size of its
  // determinant.
  const double sign = map.scale.x * map.scale.y < map.shear.x * map.shear.y ? -1 : 1;
  const Vec3d u = sign * Vec3d(dp_du), v = sign * Vec3d(dp_dv);
  return {unit_or_zero(double{map.scale.y} * u - double{map.shear.y} * v),
          unit_or_zero(double{map.scale.x} * v - double{map.shear.x} * u)};
}

Vec3 highlight_tangent(const Scene& scene, const TangentDirection& direction, const Hit& hit,
                       const SurfacePoint& surface) {
  if (is_along_u(direction)) return scene.primitives().tangents(hit, surface).along_u;
  const float rotation = direction.rotation.evaluate(scene.textures(), texture_point_at(scene, hit, surface));
  const auto turned_in_plane = [&](Vec2 components, const Tangents& along) {
    return direction_in_plane(turned(components, rotation), surface.shading_normal, along.along_u,
                              along.along_v);
  };
  if (direction.map.texture < 0) return turned_in_plane({1, 0}, scene.primitives().tangents(hit, surface));
  const Texture& map = scene.textures()[static_cast<std::size_t>(direction.map.texture)];
  return turned_in_plane(direction_in_texel(map.evaluate(uv_sets_at(scene, hit, surface))),
                         image_tangents(scene, map, hit, surface));
}

Vec3 mapped_normal(const Scene& scene, const NormalMap& map, const Hit& hit, const SurfacePoint& surface) {
  const Texture& texture = scene.textures()[static_cast<std::size_t>(map.texture)];
  const auto [along_u, along_v] = image_tangents(scene, texture, hit, surface);
  return perturb_by_normal_map(texture.evaluate(uv_sets_at(scene, hit, surface)), map.strength,
                               surface.shading_normal, along_u, along_v);
}

Vec3 bumped_normal(const Scene& scene, const Material& material, const Hit& hit, const SurfacePoint& surface,
                   Vec3 normal) {
  const Texture& heights = scene.textures()[static_cast<std::size_t>(material.bump.texture)];
  const auto [dp_du, dp_dv] = scene.primitives().uv_derivatives(hit, surface, heights.uv_set);
  const TexturePoint at = texture_point_at(scene, hit, surface);
  const HeightSlope slope =
      heights.procedural ? height_slope(heights, scene.textures(), material.bump.height, at, dp_du, dp_dv)
                         : height_slope(heights, material.bump.height, at.uv[heights.uv_set]);
  return tilt_by_heights(slope, normal, dp_du, dp_dv);
}

Vec3 outward_normal(const Scene& scene, const Material& material, const Hit& hit,
                    const SurfacePoint& surface) {
  const Vec3 normal = material.normal_map.texture < 0
                          ? surface.shading_normal
                          : mapped_normal(scene, material.normal_map, hit, surface);
  return material.bump.texture < 0 ? normal : bumped_normal(scene, material, hit, surface, normal);
}

namespace {

// The shading normal on the viewer's side.
Vec3 viewed_normal(const ViewedSide<float>& side, Vec3 outward, const MaterialModel& model, Vec3 wo) {
  const Vec3 seen = side.shading_normal(outward, wo);
  return std::holds_alternative<Lambert>(model) ? seen : ensure_valid_reflection(seen, side.normal, wo);
}

const Wavelength* pointer_to(const std::optional<Wavelength>& light) {
  return light ? &*light : nullptr;
}

}  // namespace

PathVertex::PathVertex(const Scene& scene, const Ray& ray, const Hit& hit, const Material* boundary,
                       std::optional<Wavelength> light)
    : PathVertex(scene, {boundary, light}, hit, scene.primitives().surface(ray, hit),
                 normalize(-ray.direction)) {
  time_ = ray.time;
}

PathVertex::PathVertex(const Scene& scene, const Scatterer& scatterer, const Hit& hit,
                       const SurfacePoint& surface, Vec3 wo)
    : PathVertex(scene,
                 {scatterer.material != nullptr ? scatterer.material : &scatterer_of(scene, hit, surface, wo),
                  scatterer.light},
                 hit, surface, wo, ViewedSide<float>(surface, wo)) {}

PathVertex::PathVertex(const Scene& scene, const Scatterer& scatterer, const Hit& hit,
                       const SurfacePoint& surface, Vec3 wo, const ViewedSide<float>& side)
    : VertexOf(surface, wo, side.normal,
               viewed_normal(side, outward_normal(scene, *scatterer.material, hit, surface),
                             scatterer.material->model, wo),
               scatterer.material->shading_normals == ShadingNormals::kPlain,
               shading::Bsdf(*scatterer.material,
                             {scene.textures(), texture_point_at(scene, hit, surface), side.outside,
                              scene.primitives().vertex_color(hit), true, pointer_to(scatterer.light)})),
      light_(scatterer.light),
      disperses_(disperses(scatterer.material->model)) {
  const Material& material = *scatterer.material;
  if (const TangentDirection* direction = highlight_direction(material.model))
    bsdf_.orient(frame_.to_local(highlight_tangent(scene, *direction, hit, surface)));
  if (const Principled* coated = with_own_coat_frame(material.model)) {
    const NormalMap& map = coated->geometry_coat_normal;
    const Vec3 normal =
        map.texture < 0 ? frame_.normal
                        : viewed_normal(side, mapped_normal(scene, map, hit, surface), material.model, wo);
    turn_coat(true, normal, highlight_tangent(scene, coated->coat_tangent, hit, surface));
  }
}

std::optional<PathVertex::Scattered> PathVertex::sample(Vec2 u, float u_lobe) const {
  const auto local = bsdf_.sample(wo_local_, u, u_lobe);
  if (!local) return std::nullopt;
  if (local->delta) return delta_to_world(*local);
  const FoldedSample folded = fold(local->wi_local);
  if (folded.lost) return std::nullopt;
  const Vec3 wi = normalize(frame_.to_world(folded.wi_local));
  if (!folded.reweighed) return Scattered{wi, local->weight, local->pdf, false, local->eta};
  const auto& [value, pdf] = folded.scattered;
  if (!(pdf > 0)) return std::nullopt;
  return Scattered{wi, value / pdf, pdf, false, local->eta};
}

PathVertex::Scattered PathVertex::delta_to_world(const BsdfSample& local) const {
  const Vec3 wi = normalize(frame_.to_world(local.wi_local));
  return {clamp_above_surface(wi, local.transmitted ? -side_normal_ : side_normal_), local.weight, local.pdf,
          true, local.eta};
}

std::array<std::optional<PathVertex::Scattered>, std::tuple_size_v<DeltaBranches>>
PathVertex::delta_branches() const {
  std::array<std::optional<Scattered>, std::tuple_size_v<DeltaBranches>> branches;
  const auto local = bsdf_.delta_branches(wo_local_);
  for (std::size_t i = 0; i < branches.size(); ++i)
    if (local[i]) branches[i] = delta_to_world(*local[i]);
  return branches;
}

Ray PathVertex::ray_toward(const lights::LightSample& light) const {
  return light.point ? timed(ray_to(*light.point)) : ray_along(light.wi);
}

}  // namespace tessera::core::integrators
