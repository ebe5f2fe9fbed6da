// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/primitives.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geometry/geometry_traits.hpp"
#include "core/geometry/object_point.hpp"
#include "core/math/elementary.hpp"

namespace tessera::core {
namespace {

template <typename T>
void append(std::vector<T>& all, std::vector<T> more) {
  if (all.empty() && all.capacity() < more.size()) {
    all = std::move(more);
  } else {
    all.insert(all.end(), more.begin(), more.end());
  }
}

}  // namespace

void Primitives::reserve(std::size_t vertices, std::size_t triangles) {
  positions_.reserve(positions_.size() + vertices);
  triangles_.reserve(triangles_.size() + triangles);
  triangle_materials_.reserve(triangle_materials_.size() + triangles);
}

void Primitives::add_mesh(std::vector<Vec3> positions, const std::vector<Vec3>& normals,
                          const std::vector<Vec2>& uvs, std::vector<Triangle> triangles,
                          const std::vector<std::uint32_t>& triangle_materials,
                          const std::vector<Rgb>& colors, const std::vector<Vec2>& second_uvs,
                          const std::vector<VertexTangent>& tangents) {
  const std::size_t first = positions_.size();
  append(positions_, std::move(positions));
  if (!normals.empty() || !normals_.empty()) {
    normals_.resize(first);
    normals_.reserve(positions_.size());
    for (const Vec3& normal : normals) normals_.push_back(unit_or_zero(Vec3d(normal)));
    normals_.resize(positions_.size());
  }
  if (!uvs.empty() || !uvs_.empty()) {
    uvs_.resize(first);
    uvs_.insert(uvs_.end(), uvs.begin(), uvs.end());
    uvs_.resize(positions_.size());
  }
  append_second_uvs(second_uvs, first);
  append_tangents(tangents, first);
  if (!colors.empty() || !colors_.empty()) {
    colors_.resize(first, Rgb::gray(1));
    colors_.insert(colors_.end(), colors.begin(), colors.end());
    colors_.resize(positions_.size(), Rgb::gray(1));
    has_vertex_colors_ = true;
  }
  const std::size_t first_triangle = triangles_.size(), count = triangles.size();
  append(triangles_, std::move(triangles));
  if (first > 0)
    for (std::size_t i = first_triangle; i < triangles_.size(); ++i)
      for (std::uint32_t& vertex : triangles_[i]) vertex += static_cast<std::uint32_t>(first);
  if (triangle_materials.size() == 1) {
    triangle_materials_.resize(first_triangle + count, triangle_materials[0]);
  } else {
    triangle_materials_.insert(triangle_materials_.end(), triangle_materials.begin(),
                               triangle_materials.end());
  }
}

// After the first ones.
void Primitives::append_second_uvs(const std::vector<Vec2>& second_uvs, std::size_t first_vertex) {
  if (second_uvs.empty() && second_uvs_.empty()) return;
  const auto copy_until = [&](std::size_t vertex) {
    const std::size_t known = second_uvs_.size();
    if (known < vertex && !uvs_.empty())
      second_uvs_.insert(second_uvs_.end(), uvs_.begin() + static_cast<std::ptrdiff_t>(known),
                         uvs_.begin() + static_cast<std::ptrdiff_t>(vertex));
    second_uvs_.resize(vertex);
  };
  second_uvs_.reserve(positions_.size());
  if (!second_uvs.empty()) {
    copy_until(first_vertex);
    second_uvs_.insert(second_uvs_.end(), second_uvs.begin(), second_uvs.end());
    has_second_uvs_ = true;
  }
  copy_until(positions_.size());
}

void Primitives::append_tangents(const std::vector<VertexTangent>& tangents, std::size_t first_vertex) {
  if (tangents.empty()) return;
  has_vertex_tangents_ = true;
  tangents_.resize(first_vertex);
  tangents_.reserve(positions_.size());
  for (const auto& [direction, handedness] : tangents)
    tangents_.push_back({unit_or_zero(Vec3d(direction)), handedness});
}

void Primitives::add_sphere(Vec3 center, float radius, std::uint32_t material) {
  spheres_.push_back({center, radius});
  analytic_materials_.push_back(material);
}

void Primitives::add_disk(const Disk& disk, std::uint32_t material) {
  disks_.push_back(disk);
  analytic_materials_.push_back(material);
}

void Primitives::add_cylinder(const Cylinder& cylinder, std::uint32_t material) {
  cylinders_.push_back(cylinder);
  analytic_materials_.push_back(material);
}

std::uint32_t Primitives::add_object(Primitives object) {
  outlines_.push_back(object.outline());
  has_vertex_colors_ |= object.has_vertex_colors_;
  has_second_uvs_ |= object.has_second_uvs_;
  has_vertex_tangents_ |= object.has_vertex_tangents_;
  objects_.push_back(std::move(object));
  return static_cast<std::uint32_t>(objects_.size()) - 1;
}

void Primitives::add_instance(const Instance& instance) {
  instances_.push_back(instance);
  instance_bounds_.push_back(instance_box(instance));
}

void Primitives::place_instance(std::uint32_t number, const Placement& placement) {
  instances_[number].placement = placement;
  instance_bounds_[number] = instance_box(instances_[number]);
}

void Primitives::move_instance(std::uint32_t number, MovingPlacement motion) {
  Instance& instance = instances_[number];
  instance_bounds_[number] = motion.bounds(outlines_[instance.object]);
  instance.motion = static_cast<std::uint32_t>(motions_.size());
  motions_.push_back(std::make_shared<const MovingPlacement>(std::move(motion)));
}

void Primitives::stop_instances() {
  motions_.clear();
  for (Instance& instance : instances_) instance.motion = kStill;
}

Aabb Primitives::instance_box(const Instance& instance) const {
  Aabb box;
  for (const Aabb& part : outlines_[instance.object]) box.include(instance.placement.bounds(part));
  return box;
}

// The parts are the cells of a grid over the object.
Primitives::Outline Primitives::outline() const {
  constexpr int kCells = 4;
  Aabb whole;
  for (std::uint32_t p = 0; p < count(); ++p) whole.include(bounds(p));
  const auto cell = [&](const Aabb& box, int axis) {
    const double from_lower =
        (double{box.lower[axis]} + double{box.upper[axis]}) / 2 - double{whole.lower[axis]};
    return std::clamp(static_cast<int>(kCells * from_lower / whole.extent(axis)), 0, kCells - 1);
  };
  Outline parts(kCells * kCells * kCells);
  for (std::uint32_t p = 0; p < count(); ++p) {
    const Aabb box = bounds(p);
    if (box.empty()) continue;
    int index = 0;
    for (int axis = 0; axis < 3; ++axis)
      index = kCells * index + (whole.extent(axis) > 0 ? cell(box, axis) : 0);
    parts[static_cast<std::size_t>(index)].include(box);
  }
  std::erase_if(parts, [](const Aabb& part) { return part.empty(); });
  return parts;
}

double Primitives::bounding_radius() const {
  Aabb box;
  for (std::uint32_t p = 0; p < count(); ++p) box.include(bounds(p));
  if (box.empty()) return 0;
  return std::sqrt(box.extent(0) * box.extent(0) + box.extent(1) * box.extent(1) +
                   box.extent(2) * box.extent(2)) /
         2;
}

Aabb Primitives::bounds(std::uint32_t primitive) const {
  if (is_instance(primitive)) return instance_bounds_[instance_number(primitive)];
  return with_traits(kind(primitive), [&](auto traits) { return traits.bounds(*this, primitive); });
}

double Primitives::area(std::uint32_t primitive) const {
  return with_traits(kind(primitive), [&](auto traits) -> double { return traits.area(*this, primitive); });
}

std::optional<Hit> Primitives::line_hit(GeometryKind kind, std::uint32_t primitive, const Ray& ray) const {
  return with_traits(kind, [&](auto traits) { return traits.line_hit(*this, primitive, ray); });
}

std::optional<Hit> Primitives::line_hit(GeometryKind kind, std::uint32_t primitive,
                                        const ObjectRay& ray) const {
  return with_traits(kind, [&](auto traits) { return traits.line_hit(*this, primitive, ray); });
}

bool Primitives::intersect(std::uint32_t primitive, const Ray& ray, Hit& best) const {
  if (is_instance(primitive)) return intersect_instance(instance_number(primitive), ray, best);
  const auto found = line_hit(kind(primitive), primitive, ray);
  return found && best.improve(ray, *found);
}

bool Primitives::intersect(std::uint32_t primitive, const ObjectRay& ray, Hit& best) const {
  const auto found = line_hit(kind(primitive), primitive, ray);
  return found && best.improve(ray, *found);
}

bool Primitives::intersect_instance(std::uint32_t number, const Ray& ray, Hit& hit) const {
  const Instance& shown = instances_[number];
  const Primitives& object = object_of(shown);
  const ObjectRay object_ray = to_object(shown, ray);
  Hit nearest;
  for (std::uint32_t p = 0; p < object.count(); ++p) object.intersect(p, object_ray, nearest);
  nearest.instance = number;
  return nearest.found() && hit.improve(ray, nearest);
}

SurfacePoint Primitives::surface(const Ray& ray, const Hit& hit) const {
  if (hit.in_instance()) return instance_surface(ray, hit);
  return in_world(IdentityTransform(), shape_point(ray, hit));
}

SurfacePoint Primitives::instance_surface(const Ray& ray, const Hit& hit) const {
  const Instance& shown = instances_[hit.instance];
  const Primitives& object = object_of(shown);
  return with_placement(hit, [&](const Placement& placement) {
    return in_world(placement, object.is_triangle(hit.primitive)
                                   ? object.triangle_point(hit)
                                   : object.shape_point(placement.to_object(ray), hit));
  });
}

template <typename AnyRay>
Primitives::ObjectPoint Primitives::shape_point(const AnyRay& ray, const Hit& hit) const {
  return with_traits(kind(hit.primitive), [&](auto traits) { return traits.point(*this, ray, hit); });
}

Primitives::ObjectPoint Primitives::triangle_point(const Hit& hit) const {
  const auto& [v0, v1, v2] = triangles_[hit.primitive];
  TriangleAtHit<float> at_hit{.corners = {positions_[v0], positions_[v1], positions_[v2]},
                              .normals = {},
                              .uvs = {},
                              .b1 = hit.b1,
                              .b2 = hit.b2};
  if (!normals_.empty()) at_hit.normals = {normals_[v0], normals_[v1], normals_[v2]};
  if (!uvs_.empty()) at_hit.uvs = {uvs_[v0], uvs_[v1], uvs_[v2]};
  if (is_moving_triangle(hit.primitive)) {
    const MovingTriangle moving = moving_triangle(hit.primitive, hit.time);
    at_hit.corners = moving.corners;
    at_hit.normals = moving.normals;
  }
  return point_of_triangle(at_hit);
}

VertexTangent Primitives::vertex_tangent(const Hit& hit) const {
  std::array<Vec3, 3> directions{};
  double handedness = 0;
  const std::array<double, 3> weights = corner_weights(hit.b1, hit.b2);
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const std::uint32_t vertex = triangles_[hit.primitive][corner];
    if (vertex >= tangents_.size()) return {};
    directions[corner] = tangents_[vertex].direction;
    handedness += weights[corner] * double{tangents_[vertex].handedness};
  }
  if (is_moving_triangle(hit.primitive)) directions = moving_tangents(hit.primitive, hit.time);
  const Vec3d direction = weights[0] * Vec3d(directions[0]) + weights[1] * Vec3d(directions[1]) +
                          weights[2] * Vec3d(directions[2]);
  return {direction.rounded(), handedness < 0 ? -1.0f : 1.0f};
}

// A reflection turns the bitangent over: it remains the image of that of the object.
std::optional<Tangents> Primitives::vertex_tangents(const Hit& hit, const SurfacePoint& point) const {
  if (!has_vertex_tangents_ || !owner(hit).is_triangle(hit.primitive)) return std::nullopt;
  const auto [direction, handedness] = owner(hit).vertex_tangent(hit);
  Vec3d along_u(direction);
  float side = handedness;
  if (hit.in_instance())
    with_placement(hit, [&](const Placement& placement) {
      along_u = placement.vector(along_u);
      if (placement.reflects()) side = -side;
    });
  const Vec3 unit_u = unit_or_zero(along_u);
  if (unit_u == Vec3{}) return std::nullopt;
  return Tangents{unit_u, unit_or_zero(Vec3d(cross(point.shading_normal, unit_u) * side))};
}

Tangents Primitives::tangents(const Hit& hit, const SurfacePoint& point, UvSet set) const {
  const auto of_vertices = vertex_tangents(hit, point);
  return of_vertices ? *of_vertices : uv_tangents(hit, point, set);
}

Tangents Primitives::uv_tangents(const Hit& hit, const SurfacePoint& point, UvSet set) const {
  if (hit.in_instance()) return instance_tangents(hit, point, set);
  if (is_sphere(hit.primitive)) return sphere_tangents(point.geometric_normal);
  const ModelTangents tangents = model_tangents(hit, point.geometric_normal, point.uv, set);
  return {unit_or_zero(tangents.along_u), unit_or_zero(tangents.along_v)};
}

Tangents Primitives::instance_tangents(const Hit& hit, const SurfacePoint& point, UvSet set) const {
  const Primitives& object = object_of(instances_[hit.instance]);
  return with_placement(hit, [&](const Placement& placement) -> Tangents {
    ModelTangents tangents;
    if (object.is_sphere(hit.primitive)) {
      const Vec3d normal = placement.object_normal(Vec3d(point.geometric_normal));
      const auto [east, north] = sphere_tangents(unit_or_zero(normal));
      tangents = {Vec3d(east), Vec3d(north)};
    } else {
      const Vec3 normal = object.is_curve(hit.primitive)
                              ? unit_or_zero(placement.object_normal(Vec3d(point.geometric_normal)))
                              : Vec3{};
      tangents = object.model_tangents(hit, normal, point.uv, set);
    }
    return {unit_or_zero(placement.vector(tangents.along_u)),
            unit_or_zero(placement.vector(tangents.along_v))};
  });
}

// Solves e1 = du1 dp/du + dv1 dp/dv and e2 = du2 dp/du + dv2 dp/dv.
Primitives::ModelTangents Primitives::triangle_tangents(const Hit& hit, UvSet set) const {
  if (uvs_.empty()) return {};
  const TriangleCorners corners = triangle_corners(hit.primitive, hit.time);
  const Vec3d p0(corners[0]), e1 = Vec3d(corners[1]) - p0, e2 = Vec3d(corners[2]) - p0;
  const auto [uv0, uv1, uv2] = triangle_uvs(hit.primitive, set);
  const double du1 = double{uv1.x} - double{uv0.x}, dv1 = double{uv1.y} - double{uv0.y};
  const double du2 = double{uv2.x} - double{uv0.x}, dv2 = double{uv2.y} - double{uv0.y};
  const double det = du1 * dv2 - du2 * dv1;
  constexpr double kCollinear = 1e-9;
  if (!(std::fabs(det) > kCollinear * (std::fabs(du1 * dv2) + std::fabs(du2 * dv1)))) return {};
  const double sign = det < 0 ? -1 : 1;
  return {sign * (dv2 * e1 - dv1 * e2), sign * (du1 * e2 - du2 * e1), sign * det};
}

UvDerivatives Primitives::uv_derivatives(const Hit& hit, const SurfacePoint& point, UvSet set) const {
  const auto derivatives = [](const ModelTangents& tangents, const auto& to_world) -> UvDerivatives {
    if (!(tangents.scale > 0)) return {};
    const double factor = 1 / tangents.scale;
    return {to_world(factor * tangents.along_u).rounded(), to_world(factor * tangents.along_v).rounded()};
  };
  if (!hit.in_instance())
    return derivatives(model_tangents(hit, point.geometric_normal, point.uv, set), [](Vec3d v) { return v; });
  return with_placement(hit, [&](const Placement& place) {
    const Vec3 normal = unit_or_zero(place.object_normal(Vec3d(point.geometric_normal)));
    return derivatives(object_of(instances_[hit.instance]).model_tangents(hit, normal, point.uv, set),
                       [&](Vec3d v) { return place.vector(v); });
  });
}

Primitives::ModelTangents Primitives::model_tangents(const Hit& hit, Vec3 normal, Vec2 uv, UvSet set) const {
  return with_traits(kind(hit.primitive),
                     [&](auto traits) { return traits.tangents(*this, hit, normal, uv, set); });
}

Vec2 Primitives::second_uv_at(const Hit& hit, Vec2 uv) const {
  const Primitives& mesh = owner(hit);
  if (mesh.second_uvs_.empty() || !mesh.is_triangle(hit.primitive)) return uv;
  return interpolated(mesh.triangle_uvs(hit.primitive, UvSet::kSecond), corner_weights(hit.b1, hit.b2));
}

Rgb Primitives::color_at(const Hit& hit) const {
  const Primitives& mesh = owner(hit);
  if (mesh.colors_.empty() || !mesh.is_triangle(hit.primitive)) return Rgb::gray(1);
  const auto& [v0, v1, v2] = mesh.triangles_[hit.primitive];
  const float b0 = std::max(0.0f, 1 - hit.b1 - hit.b2);
  return mesh.colors_[v0] * b0 + mesh.colors_[v1] * hit.b1 + mesh.colors_[v2] * hit.b2;
}

}  // namespace tessera::core
