// SPDX-License-Identifier: Apache-2.0
#include "core/integrators/caustic_casters.hpp"

#include <cmath>
#include <map>
#include <utility>
#include <variant>

#include "core/math/elementary.hpp"
#include "core/sampling/warp.hpp"

namespace tessera::core::integrators {
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

// A point of a shape that is no instance, uniform on its area, and a normal there of any length.
struct ShapePoint {
  Vec3 position;
  Vec3d normal;
};

ShapePoint sample_shape(const Primitives& shapes, std::uint32_t primitive, Vec2 u) {
  if (shapes.is_sphere(primitive)) {
    const Sphere& sphere = shapes.sphere(primitive);
    const Vec3 direction = sampling::sample_sphere(u);
    return {sphere.center + direction * sphere.radius, Vec3d(direction)};
  }
  if (shapes.is_disk(primitive)) {
    const Disk& disk = shapes.disk(primitive);
    const RingPoint point = sample_ring(disk.inner, u);
    return {disk.center + disk.radius_u * point.x + disk.radius_v * point.y, disk.normal()};
  }
  // Uniform on the area of a circular cylinder.
  if (shapes.is_cylinder(primitive)) {
    const Cylinder& cylinder = shapes.cylinder(primitive);
    const auto [along_u, along_v] = cylinder.derivatives(u);
    return {cylinder.position(u).rounded(), cross(along_u, along_v)};
  }
  const auto [p0, p1, p2] = shapes.triangle_corners(primitive);
  const Vec2 b = sampling::sample_triangle(u);
  return {p0 * (1 - b.x - b.y) + p1 * b.x + p2 * b.y, cross(Vec3d(p1) - Vec3d(p0), Vec3d(p2) - Vec3d(p0))};
}

// The factor by which the map scales the area of a surface with this normal.
double area_scale(const AffineMapOf<double>& map, Vec3d normal) {
  const double determinant = std::fabs(dot(cross(map.x_axis, map.y_axis), map.z_axis));
  return determinant * length(map.normal(normal)) / length(normal);
}

// About that factor for surfaces of all normals.
double mean_area_scale(const AffineMapOf<double>& map) {
  return (length(cross(map.x_axis, map.y_axis)) + length(cross(map.y_axis, map.z_axis)) +
          length(cross(map.z_axis, map.x_axis))) /
         3;
}

}  // namespace

CausticCasters::CausticCasters(const Scene& scene) : scene_(scene) {
  for (const Material& material : scene.materials()) casts_.push_back(casts_caustics(material.model));
  const Primitives& all = scene.primitives();
  std::vector<double> weights;
  const auto add_group = [&](std::uint32_t instance, std::uint32_t list, double scale) {
    const double weight = lists_[list].area * scale;
    if (!(weight > 0)) return;
    groups_.push_back({instance, list, weight});
    weights.push_back(weight);
    weight_ += weight;
  };
  add_group(kNoInstance, add_list(all, kOwnMaterials), 1);
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> lists;  // by object and material
  for (std::uint32_t i = 0; i < all.instance_count(); ++i) {
    const Instance& instance = all.instance(i);
    const auto [entry, is_new] = lists.try_emplace({instance.object, instance.material}, 0);
    if (is_new) entry->second = add_list(all.object_of(instance), instance.material);
    add_group(i, entry->second, mean_area_scale(instance.placement.map()));
  }
  if (!weights.empty()) by_weight_ = sampling::DiscreteDistribution(weights);
}

// Lists the casters among shapes that have the material `shown`, or their own.
std::uint32_t CausticCasters::add_list(const Primitives& shapes, std::uint32_t shown) {
  List list{.shapes = &shapes};
  std::vector<double> areas;
  for (std::uint32_t p = 0; p < shapes.shape_count(); ++p) {
    if (!casts_[shown == kOwnMaterials ? shapes.material(p) : shown]) continue;
    const double area = shapes.area(p);
    if (!(area > 0)) continue;
    list.primitives.push_back(p);
    areas.push_back(area);
    list.area += area;
  }
  if (!areas.empty()) list.by_area = sampling::DiscreteDistribution(areas);
  lists_.push_back(std::move(list));
  return static_cast<std::uint32_t>(lists_.size() - 1);
}

CausticCasters::Place CausticCasters::sample(double u_choice, Vec2 u) const {
  const auto [group_number, u_primitive] = by_weight_.sample_and_rest(u_choice);
  const Group& group = groups_[group_number];
  const List& list = lists_[group.list];
  const std::uint32_t primitive = list.primitives[list.by_area.sample(u_primitive)];
  const auto [position, normal] = sample_shape(*list.shapes, primitive, u);
  const double per_area = weight_ / group.weight * list.area;
  if (group.instance == kNoInstance) return {primitive, kNoInstance, position, per_area};
  const AffineMapOf<double>& map = scene_.primitives().instance(group.instance).placement.map();
  return {primitive, group.instance, map.point(Vec3d(position)).rounded(),
          per_area * area_scale(map, normal)};
}

}  // namespace tessera::core::integrators
