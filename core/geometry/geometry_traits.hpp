// SPDX-License-Identifier: Apache-2.0
// What is done with the primitives of each kind of shape; part of primitives.cpp. A new kind needs a
// GeometryKind, a case in Primitives::kind and in with_traits, and these functions:
//
// bounds: of every point that a ray can hit; empty if there is none.
// area: 0 if it is never sampled.
// line_hit: the nearest hit of the line in front of the ray's origin, wherever the ray ends.
// point: the surface point at a hit.
// tangents: dp/du and dp/dv at a hit, given the object-space normal and the texture coordinates.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <limits>
#include <optional>

#include "core/geometry/object_point.hpp"
#include "core/geometry/primitives.hpp"
#include "core/geometry/rounding.hpp"

namespace tessera::core {

template <typename AnyRay>
std::optional<Hit> triangle_line_hit(const TriangleCorners& corners, std::uint32_t primitive,
                                     const AnyRay& ray, float time) {
  const auto found = intersect_triangle(ShearedRay(ray), corners);
  if (!found || !can_be_hit(corners)) return std::nullopt;
  return Hit{found->t, primitive, found->b1, found->b2, kNoInstance, time};
}

template <>
struct Primitives::Traits<GeometryKind::kTriangle> {
  static Aabb bounds(const Primitives& all, std::uint32_t primitive) {
    Aabb box;
    const TriangleCorners corners = all.triangle_corners(primitive);
    if (!can_be_hit(corners)) return box;
    for (const Vec3& corner : corners) box.include(corner);
    return box;
  }
  static double area(const Primitives& all, std::uint32_t primitive) {
    const auto [p0, p1, p2] = all.triangle_corners(primitive);
    return static_cast<double>(length(cross(Vec3d(p1) - Vec3d(p0), Vec3d(p2) - Vec3d(p0)))) / 2;
  }
  template <typename AnyRay>
  static std::optional<Hit> line_hit(const Primitives& all, std::uint32_t primitive, const AnyRay& ray) {
    return triangle_line_hit(all.triangle_corners(primitive), primitive, ray, 0);
  }
  template <typename AnyRay>
  static ObjectPoint point(const Primitives& all, const AnyRay&, const Hit& hit) {
    return all.triangle_point(hit);
  }
  static ModelTangents tangents(const Primitives& all, const Hit& hit, Vec3, Vec2, UvSet set) {
    return all.triangle_tangents(hit, set);
  }
};

template <>
struct Primitives::Traits<GeometryKind::kMovingTriangle> : Primitives::Traits<GeometryKind::kTriangle> {
  static Aabb bounds(const Primitives& all, std::uint32_t primitive) {
    return all.moving_triangle_bounds(primitive);
  }
  template <typename AnyRay>
  static std::optional<Hit> line_hit(const Primitives& all, std::uint32_t primitive, const AnyRay& ray) {
    return triangle_line_hit(all.triangle_corners(primitive, ray.time), primitive, ray, ray.time);
  }
};

template <>
struct Primitives::Traits<GeometryKind::kSphere> {
  // Rounded outwards, and finite however large the sphere.
  static Aabb bounds(const Primitives& all, std::uint32_t primitive) {
    constexpr float kLargest = std::numeric_limits<float>::max();
    const Sphere& sphere = all.sphere(primitive);
    Aabb box;
    if (!can_be_hit(sphere)) return box;
    for (int axis = 0; axis < 3; ++axis) {
      box.lower[axis] = std::max(next_float_down(sphere.center[axis] - sphere.radius), -kLargest);
      box.upper[axis] = std::min(next_float_up(sphere.center[axis] + sphere.radius), kLargest);
    }
    return box;
  }
  static double area(const Primitives& all, std::uint32_t primitive) {
    const auto radius = static_cast<double>(all.sphere(primitive).radius);
    return 4 * static_cast<double>(kPi) * radius * radius;
  }
  template <typename AnyRay>
  static std::optional<Hit> line_hit(const Primitives& all, std::uint32_t primitive, const AnyRay& ray) {
    const auto t = intersect_sphere(ray, all.sphere(primitive));
    if (!t) return std::nullopt;
    return Hit{static_cast<float>(*t), primitive, 0, 0};
  }
  template <typename AnyRay>
  static ObjectPoint point(const Primitives& all, const AnyRay& ray, const Hit& hit) {
    return point_of_sphere(all.sphere(hit.primitive), Vec3d(ray.origin), Vec3d(ray.direction), hit.t);
  }
  static ModelTangents tangents(const Primitives& all, const Hit& hit, Vec3 normal, Vec2, UvSet) {
    const auto [east, north] = sphere_tangents(normal);
    const double half_turn = static_cast<double>(kPi) * static_cast<double>(all.sphere(hit.primitive).radius);
    const double equatorial = length(Vec3d(normal.x, 0, normal.z));
    return {2 * half_turn * equatorial * Vec3d(east), half_turn * Vec3d(north), 1};
  }
};

// Of shapes that are hit in double and hold all that is asked of them; `kShape` is the getter of Primitives.
template <auto kShape>
struct Primitives::AnalyticTraits {
  static Aabb bounds(const Primitives& all, std::uint32_t primitive) {
    return (all.*kShape)(primitive).bounds();
  }
  static double area(const Primitives& all, std::uint32_t primitive) {
    return (all.*kShape)(primitive).area();
  }
  template <typename AnyRay>
  static std::optional<Hit> line_hit(const Primitives& all, std::uint32_t primitive, const AnyRay& ray) {
    const auto found = (all.*kShape)(primitive).intersect(ObjectRay(ray));
    if (!found) return std::nullopt;
    return Hit{static_cast<float>(found->t), primitive, 0, 0};
  }
  template <typename AnyRay>
  static ObjectPoint point(const Primitives& all, const AnyRay& ray, const Hit& hit) {
    return (all.*kShape)(hit.primitive).point(ObjectRay(ray));
  }
  static ModelTangents tangents(const Primitives& all, const Hit& hit, Vec3, Vec2 uv, UvSet) {
    const auto [along_u, along_v] = (all.*kShape)(hit.primitive).derivatives(uv);
    return {along_u, along_v, 1};
  }
};

template <>
struct Primitives::Traits<GeometryKind::kDisk> : Primitives::AnalyticTraits<&Primitives::disk> {};

template <>
struct Primitives::Traits<GeometryKind::kCylinder> : Primitives::AnalyticTraits<&Primitives::cylinder> {};

template <>
struct Primitives::Traits<GeometryKind::kCurve> {
  static Aabb bounds(const Primitives& all, std::uint32_t primitive) { return all.curve(primitive).bounds(); }
  static double area(const Primitives&, std::uint32_t) { return 0; }
  template <typename AnyRay>
  static std::optional<Hit> line_hit(const Primitives& all, std::uint32_t primitive, const AnyRay& ray) {
    return all.curve_line_hit(primitive, all.curve_source(primitive), ray);
  }
  template <typename AnyRay>
  static ObjectPoint point(const Primitives& all, const AnyRay& ray, const Hit& hit) {
    return all.curves_.point(hit.primitive - all.first_curve(), ObjectRay(ray), hit.b1, hit.b2);
  }
  static ModelTangents tangents(const Primitives& all, const Hit& hit, Vec3 normal, Vec2 uv, UvSet) {
    const auto [along_u, along_v] = all.curves_.derivatives(hit.primitive - all.first_curve(), normal, uv);
    return {along_u, along_v, 1};
  }
};

// Calls what(Traits) for a kind of shape, which is no instance.
template <typename What>
decltype(auto) Primitives::with_traits(GeometryKind kind, const What& what) {
  switch (kind) {
    case GeometryKind::kTriangle:
      return what(Traits<GeometryKind::kTriangle>());
    case GeometryKind::kMovingTriangle:
      return what(Traits<GeometryKind::kMovingTriangle>());
    case GeometryKind::kSphere:
      return what(Traits<GeometryKind::kSphere>());
    case GeometryKind::kDisk:
      return what(Traits<GeometryKind::kDisk>());
    case GeometryKind::kCylinder:
      return what(Traits<GeometryKind::kCylinder>());
    case GeometryKind::kCurve:
      return what(Traits<GeometryKind::kCurve>());
    case GeometryKind::kInstance:
      break;
  }
  assert(false && "an instance is no shape");
  __builtin_unreachable();
}

}  // namespace tessera::core
