// SPDX-License-Identifier: Apache-2.0
#include "core/integrators/caustic_casters.hpp"

#include <variant>

#include "core/geometry/vec3d.hpp"
#include "core/math/elementary.hpp"
#include "core/sampling/warp.hpp"

namespace tessera::core {
namespace {

// Rougher surfaces spread light so widely, and surfaces with a stronger diffuse part scatter so much light,
// that other sampling techniques suffice.
constexpr float kMaxRoughness = 0.05f, kMaxDiffuse = 0.1f, kMinSpecular = 1 - kMaxDiffuse;

bool is_smooth(const ScalarParameter& roughness) {
  return roughness.texture < 0 && roughness.value <= kMaxRoughness;
}

bool casts_caustics(const MaterialModel& model) {
  if (const auto* glass = std::get_if<Glass>(&model)) return is_smooth(glass->roughness);
  if (const auto* solid = std::get_if<Principled>(&model))
    return is_smooth(solid->specular_roughness) &&
           (solid->transmission_weight.value > kMinSpecular || solid->base_metalness.value > kMinSpecular);
  if (const auto* metal = std::get_if<ConductorMaterial>(&model)) return is_smooth(metal->roughness);
  if (const auto* metal = std::get_if<CookTorrance>(&model))
    return is_smooth(metal->roughness) && max_component(metal->diffuse.value) < kMaxDiffuse;
  return std::holds_alternative<Mirror>(model);
}

}  // namespace

CausticCasters::CausticCasters(const Scene& scene) : scene_(scene) {
  for (const Material& material : scene.materials()) casts_.push_back(casts_caustics(material.model));
  std::vector<double> areas;
  const std::uint32_t count = scene.primitives().shape_count();
  for (std::uint32_t p = 0; p < count; ++p) {
    if (!contain({.primitive = p})) continue;
    const double area = scene.primitives().area(p);
    if (!(area > 0)) continue;
    primitives_.push_back(p);
    areas.push_back(area);
    area_ += area;
  }
  if (!areas.empty()) by_area_ = DiscreteDistribution(areas);
}

CausticCasters::Place CausticCasters::sample(double u_choice, Vec2 u) const {
  const std::uint32_t primitive = primitives_[by_area_.sample(u_choice)];
  const Primitives& all = scene_.primitives();
  if (all.is_sphere(primitive)) {
    const Sphere& sphere = all.sphere(primitive);
    return {primitive, sphere.center + sample_sphere(u) * sphere.radius};
  }
  if (all.is_disk(primitive)) {
    const Disk& disk = all.disk(primitive);
    const RingPoint point = sample_ring(disk.inner, u);
    return {primitive, disk.center + disk.radius_u * point.x + disk.radius_v * point.y};
  }
  // Uniform on the area of a circular cylinder.
  if (all.is_cylinder(primitive)) return {primitive, all.cylinder(primitive).position(u).rounded()};
  const auto [p0, p1, p2] = all.triangle_corners(primitive);
  const Vec2 b = sample_triangle(u);
  return {primitive, p0 * (1 - b.x - b.y) + p1 * b.x + p2 * b.y};
}

}  // namespace tessera::core
