// Rays against one sphere, in double from float data.
#pragma once

#include <cmath>
#include <optional>

#include "core/geometry/object_ray.hpp"
#include "core/geometry/ray.hpp"
#include "core/geometry/surface.hpp"
#include "core/geometry/vec3d.hpp"

namespace tessera::core {

struct Sphere {
  Vec3 center;
  float radius = 1;
};

// Whether it has a surface; spheres that have none are never hit.
inline bool can_be_hit(const Sphere& sphere) {
  return is_finite(sphere.center) && sphere.radius > 0 && std::isfinite(sphere.radius);
}

// The least provably positive t of the line's two intersections. An origin that cannot be told from a point
// of the sphere counts as on it: from there only the far side can be hit.
std::optional<double> intersect_sphere(const ObjectRay& ray, const Sphere& sphere);
inline std::optional<double> intersect_sphere(const Ray& ray, const Sphere& sphere) {
  return intersect_sphere(ObjectRay(ray), sphere);
}

// (u, v) of a point in direction `normal` from the centre. u in [0, 1) is the longitude over 2 pi,
// counter-clockwise about +y from +x; v is the latitude, 0 at the pole -y and 1 at the pole +y, uniform in
// angle.
Vec2 sphere_uv(Vec3 normal);
// Eastwards and northwards; none at the poles.
Tangents sphere_tangents(Vec3 normal);

}  // namespace tessera::core
