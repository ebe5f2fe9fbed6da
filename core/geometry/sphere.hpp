// SPDX-License-Identifier: Apache-2.0
// Ray-sphere intersection, in double from float data. T is float for one pair, or FloatN
// (core/math/simd_double.hpp) or FloatVector for many.
#pragma once

#include <cmath>
#include <limits>
#include <optional>

#include "core/geometry/object_point.hpp"
#include "core/geometry/object_ray.hpp"
#include "core/geometry/ray.hpp"
#include "core/geometry/rounding.hpp"
#include "core/geometry/surface.hpp"
#include "core/geometry/vec3d.hpp"
#include "core/math/elementary.hpp"

namespace tessera::core {

template <typename T>
struct SphereOf {
  Vec3Of<T> center;
  T radius = 1.0f;
};
using Sphere = SphereOf<float>;

// Whether the sphere has a surface; spheres without one are never hit.
template <typename T>
MaskOf<T> can_be_hit(const SphereOf<T>& sphere) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const Vec3Of<T> center = abs(sphere.center);
  return (center.x < kInfinity) & (center.y < kInfinity) & (center.z < kInfinity) & (sphere.radius > 0) &
         (sphere.radius < kInfinity);
}

template <typename T>
struct SphereHitOf {
  MaskOf<T> found;
  WideOf<T> t;
};

// The smallest provably positive t of the line's two intersections. An origin that is indistinguishable
// from a point of the sphere counts as on it: from there only the far side can be hit.
//
// Haines, Guenther and Akenine-Moeller 2019: the discriminant is computed from the centre's distance to the
// line, without cancellation for small and distant spheres. The roots avoid cancellation too (Press et al.
// 2007, eq. 5.6.4).
template <typename T>
SphereHitOf<T> intersect_sphere(const Vec3dOf<WideOf<T>>& origin, const Vec3dOf<WideOf<T>>& d,
                                const SphereOf<T>& sphere) {
  using D = WideOf<T>;
  using std::sqrt;
  const Vec3dOf<D> f = origin - Vec3dOf<D>(sphere.center);
  const D r2 = widened(sphere.radius) * widened(sphere.radius);
  const D a = dot(d, d), b = -dot(f, d), ff = dot(f, f);
  const Vec3dOf<D> closest = f + (b / a) * d;
  const D discriminant = r2 - dot(closest, closest);
  MaskOf<T> found = (discriminant >= 0.0) & can_be_hit(sphere);
  if (!any(found)) return {found, 0.0};

  const MaskOf<T> ahead = b > 0.0;
  const D root = sqrt(a * discriminant);
  const D q = b + select(ahead, root, -root);  // at the centre b is a zero of either sign
  const D c = ff - r2, c_error = D(gamma<double>(8)) * (ff + r2);
  const MaskOf<T> outside = c > c_error, inside = c < -c_error;
  found = found & (ahead | inside);
  const MaskOf<T> on_it = found & !(outside | inside);
  if (any(on_it))  // the ray may leave or be tangent
    found = found & ((b > D(gamma<double>(8)) * sqrt(ff * a)) | !on_it);
  const MaskOf<T> nearer = outside | (inside & !ahead);
  return {found, select(nearer, c, q) / select(nearer, q, a)};
}

inline std::optional<double> intersect_sphere(const ObjectRay& ray, const Sphere& sphere) {
  const auto [found, t] = intersect_sphere<float>(ray.origin, ray.direction, sphere);
  return found ? std::optional(t) : std::nullopt;
}
inline std::optional<double> intersect_sphere(const Ray& ray, const Sphere& sphere) {
  return intersect_sphere(ObjectRay(ray), sphere);
}

// (u, v) of a point in direction `normal` from the centre. u in [0, 1) is the longitude over 2 pi,
// counter-clockwise about +y from +x; v is the latitude, 0 at the pole -y and 1 at the pole +y, uniform in
// angle.
template <typename T = float>
Vec2Of<T> sphere_uv(Vec3Of<T> normal) {
  using std::sqrt;
  constexpr float kInvPi = 1 / kPi;
  const T longitude = 0.5f * kInvPi * atan2(-normal.z, normal.x);
  const T u = select(longitude < 0, longitude + 1, longitude);
  const T equatorial = sqrt(normal.x * normal.x + normal.z * normal.z);
  const T v = 0.5f + kInvPi * atan2(normal.y, equatorial);
  return {select(u < 1, u, T(0.0f)), smaller(larger(v, T(0.0f)), T(1.0f))};
}

// Unit vectors east and north; zero at the poles.
Tangents sphere_tangents(Vec3 normal);

// The surface where a ray met the sphere; the float t is intersect_sphere()'s result, rounded.
template <typename T>
ObjectPointOf<T> point_of_sphere(const SphereOf<T>& sphere, const Vec3dOf<WideOf<T>>& origin,
                                 const Vec3dOf<WideOf<T>>& direction, T rounded_t) {
  using D = WideOf<T>;
  using Wide = Vec3dOf<D>;
  const Wide center(sphere.center);
  // A float t may be coarser than a distant sphere, so the exact t is computed again.
  const auto [found, exact_t] = intersect_sphere(origin, direction, sphere);
  const D t = select(found, exact_t, widened(rounded_t));
  const Wide from_center = origin + t * direction - center;
  const Wide normal = (1.0 / length(from_center)) * from_center;
  const Wide arm = widened(sphere.radius) * normal;

  ObjectPointOf<T> point;
  point.position = center + arm;
  point.terms = abs(center) + abs(arm);
  point.geometric_normal = from_center;
  point.shading_normal = {};
  point.uv = sphere_uv(normal.rounded());
  return point;
}

}  // namespace tessera::core
