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
constexpr float kMaxRoughness = 0.05f, kMaxDiffuse = 0.1f;

bool is_smooth(const ScalarParameter& roughness) {
  return roughness.texture < 0 && roughness.value <= kMaxRoughness;
}

bool casts_caustics(const MaterialModel& model) {
  if (const auto* glass = std::get_if<Glass>(&model)) return is_smooth(glass->roughness);
  if (const auto* metal = std::get_if<CookTorrance>(&model))
    return is_smooth(metal->roughness) && max_component(metal->diffuse.value) < kMaxDiffuse;
  return std::holds_alternative<Mirror>(model);
}

double area_of(const Primitives& primitives, std::uint32_t primitive) {
  if (primitives.is_sphere(primitive)) {
    const auto radius = static_cast<double>(primitives.sphere(primitive).radius);
    return 4 * static_cast<double>(kPi) * radius * radius;
  }
  const auto [p0, p1, p2] = primitives.triangle_corners(primitive);
  return static_cast<double>(length(cross(Vec3d(p1) - Vec3d(p0), Vec3d(p2) - Vec3d(p0)))) / 2;
}

}  // namespace

CausticCasters::CausticCasters(const Scene& scene) : scene_(scene) {
  for (const Material& material : scene.materials()) casts_.push_back(casts_caustics(material.model));
  std::vector<double> areas;
  const std::uint32_t count = scene.primitives().triangle_count() + scene.primitives().sphere_count();
  for (std::uint32_t p = 0; p < count; ++p) {
    if (!contain({.primitive = p})) continue;
    const double area = area_of(scene.primitives(), p);
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
  const auto [p0, p1, p2] = all.triangle_corners(primitive);
  const Vec2 b = sample_triangle(u);
  return {primitive, p0 * (1 - b.x - b.y) + p1 * b.x + p2 * b.y};
}

}  // namespace tessera::core
