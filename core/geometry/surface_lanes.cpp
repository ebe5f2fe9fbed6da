// SPDX-License-Identifier: Apache-2.0
// Surface points in lanes: one function for each kind of primitive, called for the lanes of that kind.
//
// To add a kind: name it in Primitives::SurfaceKind and tell it in surface_kind(); write its function beside
// these, which gathers what the kind stores into lanes and evaluates the template that the scalar surface()
// evaluates; and call it in surfaces_of(). Until then its surfaces are computed one by one. Tests compare
// every lane with surface().
#include <bit>
#include <optional>

#include "core/geometry/object_point.hpp"
#include "core/geometry/primitives.hpp"
#include "core/geometry/surface_points.hpp"
#include "core/math/row_lookup.hpp"

namespace tessera::core {
namespace {

constexpr unsigned kAllLanes = (1u << kLaneCount) - 1;

Vec3Of<FloatN> look_up_vectors(const std::vector<Vec3>& table, U32xN index) {
  const auto [x, y, z] = look_up_row<3>(&table[0].x, index * 3u);
  return {x, y, z};
}
Vec2Of<FloatN> look_up_vectors(const std::vector<Vec2>& table, U32xN index) {
  const auto [x, y] = look_up_row<2>(&table[0].x, index * 2u);
  return {x, y};
}

// Fills the lanes outside a set with one of the set's lanes.
template <typename Rows>
Rows filled(const Rows& all, unsigned set) {
  return all.filled(set, static_cast<std::size_t>(std::countr_zero(set)));
}

void set_barycentrics(const HitRows& hits, TriangleAtHit<FloatN>& at_hit) {
  at_hit.b1 = hits.all(&Hit::b1);
  at_hit.b2 = hits.all(&Hit::b2);
}

// A coordinate vector of a map, of the maps in all lanes.
template <typename Member>
Vec3dOf<DoubleN> gathered(const std::array<const AffineMapOf<double>*, kLaneCount>& maps, Member member) {
  alignas(64) double x[kLaneCount], y[kLaneCount], z[kLaneCount];
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    const Vec3d& v = maps[lane]->*member;
    x[lane] = v.x, y[lane] = v.y, z[lane] = v.z;
  }
  return {DoubleN::load(x), DoubleN::load(y), DoubleN::load(z)};
}

using WideLanes = Vec3dOf<DoubleN>;

// What a ray hits of a sphere, and where from.
struct SpheresAtHits {
  // sphere_at(lane) is the sphere in a lane.
  template <typename SphereAt>
  SpheresAtHits(const RayRows& rays, const HitRows& hits, const SphereAt& sphere_at) {
    Vec3Lanes centers;
    FloatLanes radii;
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
      const Sphere& sphere = sphere_at(lane);
      centers.set(lane, sphere.center);
      radii.set(lane, sphere.radius);
    }
    origin = WideLanes(rays.all(&Ray::origin)), direction = WideLanes(rays.all(&Ray::direction));
    t = hits.all(&Hit::t);
    spheres = {centers.all(), radii.all()};
  }

  WideLanes origin, direction;
  FloatN t;
  SphereOf<FloatN> spheres;
};

}  // namespace

Primitives::SurfaceKind Primitives::surface_kind(const Hit& hit) const {
  const Primitives& mesh = owner(hit);
  if (mesh.is_moving_triangle(hit.primitive))
    return hit.in_instance() ? kInstancedMovingTriangle : kMovingTriangle;
  if (mesh.is_triangle(hit.primitive)) return hit.in_instance() ? kInstancedTriangle : kPlainTriangle;
  if (mesh.is_sphere(hit.primitive)) return hit.in_instance() ? kInstancedSphere : kPlainSphere;
  return kOtherSurface;
}

SurfacePointOf<FloatN> Primitives::surfaces_of(SurfaceKind kind, unsigned lanes, const RayRows& rays,
                                               const HitRows& hits) const {
  switch (kind) {
    case kPlainTriangle:
      return triangle_surfaces(filled(hits, lanes));
    case kInstancedTriangle:
      return instanced_triangle_surfaces(filled(hits, lanes));
    case kMovingTriangle:
      return in_world(IdentityTransform(), moving_triangle_points(filled(hits, lanes)));
    case kInstancedMovingTriangle: {
      const HitRows all = filled(hits, lanes);
      return in_world(placements_of(all), moving_triangle_points(all));
    }
    case kPlainSphere:
      return sphere_surfaces(filled(rays, lanes), filled(hits, lanes));
    case kInstancedSphere:
      return instanced_sphere_surfaces(filled(rays, lanes), filled(hits, lanes));
    case kOtherSurface:
      break;
  }
  return surfaces_one_by_one(lanes, rays, hits);
}

SurfacePointOf<FloatN> Primitives::surfaces(const RayRows& rays, const HitRows& hits) const {
  std::array<unsigned, kSurfaceKinds> lanes_of{};
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) lanes_of[surface_kind(hits[lane])] |= 1u << lane;
  SurfacePointOf<FloatN> all;
  for (std::size_t kind = 0; kind < kSurfaceKinds; ++kind) {
    const unsigned lanes = lanes_of[kind];
    if (lanes == 0) continue;
    const auto of_kind = surfaces_of(static_cast<SurfaceKind>(kind), lanes, rays, hits);
    if (lanes == kAllLanes) return of_kind;
    all = select(MaskN::from_bits(lanes), of_kind, all);
  }
  return all;
}

SurfacePointOf<FloatN> Primitives::triangle_surfaces(const HitRows& hits) const {
  const auto vertices = look_up_row<3>(triangles_[0].data(), hits.all(&Hit::primitive) * 3u);
  TriangleAtHit<FloatN> at_hit;
  set_barycentrics(hits, at_hit);
  for (std::size_t corner = 0; corner < 3; ++corner) {
    at_hit.corners[corner] = look_up_vectors(positions_, vertices[corner]);
    if (!normals_.empty()) at_hit.normals[corner] = look_up_vectors(normals_, vertices[corner]);
    if (!uvs_.empty()) at_hit.uvs[corner] = look_up_vectors(uvs_, vertices[corner]);
  }
  return in_world(IdentityTransform(), point_of_triangle(at_hit));
}

AffineMapOf<DoubleN> Primitives::placements_of(const HitRows& hits) const {
  std::array<const AffineMapOf<double>*, kLaneCount> maps;
  std::array<std::optional<Placement>, kLaneCount> moved;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    const Instance& shown = instances_[hits.get(&Hit::instance, lane)];
    if (shown.motion != kStill) moved[lane] = motions_[shown.motion]->at(hits.get(&Hit::time, lane));
    maps[lane] = moved[lane] ? &moved[lane]->map() : &shown.placement.map();
  }
  using Map = AffineMapOf<double>;
  return {gathered(maps, &Map::x_axis),   gathered(maps, &Map::y_axis),    gathered(maps, &Map::z_axis),
          gathered(maps, &Map::origin),   gathered(maps, &Map::inverse_x), gathered(maps, &Map::inverse_y),
          gathered(maps, &Map::inverse_z)};
}

// Each lane reads the arrays of its own object.
SurfacePointOf<FloatN> Primitives::instanced_triangle_surfaces(const HitRows& hits) const {
  std::array<const Primitives*, kLaneCount> objects;
  std::array<const Triangle*, kLaneCount> triangles;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    objects[lane] = &object_of(instances_[hits.get(&Hit::instance, lane)]);
    triangles[lane] = &objects[lane]->triangles_[hits.get(&Hit::primitive, lane)];
  }
  static constexpr float kMissing[3] = {};
  const auto row_of = [&](const auto& table, std::size_t lane, std::size_t corner) {
    return table.empty() ? kMissing : &table[(*triangles[lane])[corner]].x;
  };
  TriangleAtHit<FloatN> at_hit;
  set_barycentrics(hits, at_hit);
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const auto [x, y, z] = load_rows<3>(
        [&](std::size_t lane) { return &objects[lane]->positions_[(*triangles[lane])[corner]].x; });
    const auto [normal_x, normal_y, normal_z] =
        load_rows<3>([&](std::size_t lane) { return row_of(objects[lane]->normals_, lane, corner); });
    const auto [u, v] =
        load_rows<2>([&](std::size_t lane) { return row_of(objects[lane]->uvs_, lane, corner); });
    at_hit.corners[corner] = {x, y, z};
    at_hit.normals[corner] = {normal_x, normal_y, normal_z};
    at_hit.uvs[corner] = {u, v};
  }
  return in_world(placements_of(hits), point_of_triangle(at_hit));
}

// The vertices are interpolated lane by lane.
ObjectPointOf<FloatN> Primitives::moving_triangle_points(const HitRows& hits) const {
  std::array<Vec3Lanes, 3> corners, normals;
  std::array<FloatLanes, 3> u, v;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    const Hit hit = hits[lane];
    const Primitives& mesh = owner(hit);
    const MovingTriangle moving = mesh.moving_triangle(hit.primitive, hit.time);
    const std::array<Vec2, 3> uvs = mesh.triangle_uvs(hit.primitive);
    for (std::size_t corner = 0; corner < 3; ++corner) {
      corners[corner].set(lane, moving.corners[corner]);
      normals[corner].set(lane, moving.normals[corner]);
      u[corner].set(lane, uvs[corner].x);
      v[corner].set(lane, uvs[corner].y);
    }
  }
  TriangleAtHit<FloatN> at_hit;
  set_barycentrics(hits, at_hit);
  for (std::size_t corner = 0; corner < 3; ++corner) {
    at_hit.corners[corner] = corners[corner].all();
    at_hit.normals[corner] = normals[corner].all();
    at_hit.uvs[corner] = {u[corner].all(), v[corner].all()};
  }
  return point_of_triangle(at_hit);
}

SurfacePointOf<FloatN> Primitives::sphere_surfaces(const RayRows& rays, const HitRows& hits) const {
  const SpheresAtHits at(
      rays, hits, [&](std::size_t lane) -> const Sphere& { return sphere(hits.get(&Hit::primitive, lane)); });
  return in_world(IdentityTransform(), point_of_sphere(at.spheres, at.origin, at.direction, at.t));
}

SurfacePointOf<FloatN> Primitives::instanced_sphere_surfaces(const RayRows& rays, const HitRows& hits) const {
  const SpheresAtHits at(rays, hits, [&](std::size_t lane) -> const Sphere& {
    return owner(hits[lane]).sphere(hits.get(&Hit::primitive, lane));
  });
  const AffineMapOf<DoubleN> place = placements_of(hits);
  return in_world(place, point_of_sphere(at.spheres, place.object_point(at.origin),
                                         place.object_vector(at.direction), at.t));
}

SurfacePointOf<FloatN> Primitives::surfaces_one_by_one(unsigned lanes, const RayRows& rays,
                                                       const HitRows& hits) const {
  SurfacePoints points;
  for (; lanes != 0; lanes &= lanes - 1) {
    const auto lane = static_cast<std::size_t>(std::countr_zero(lanes));
    points.set(lane, surface(rays[lane], hits[lane]));
  }
  return points.all();
}

Vec2Of<FloatN> Primitives::second_uvs_at(const HitRows& hits, Vec2Of<FloatN> uv) const {
  FloatLanes u(uv.x), v(uv.y);
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    const Vec2 second = second_uv_at(hits[lane], {u[lane], v[lane]});
    u.set(lane, second.x);
    v.set(lane, second.y);
  }
  return {u.all(), v.all()};
}

RgbOf<FloatN> Primitives::vertex_colors(const HitRows& hits) const {
  RgbLanes colors;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) colors.set(lane, color_at(hits[lane]));
  return colors.all();
}

}  // namespace tessera::core
