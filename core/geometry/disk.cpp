// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/disk.hpp"

#include <cmath>
#include <numbers>

#include "core/geometry/rounding.hpp"

namespace tessera::core {

double Disk::area() const {
  return std::numbers::pi * length(normal()) * (1 - double{inner} * double{inner});
}

bool Disk::can_be_hit() const {
  return is_finite(center) && inner >= 0 && inner < 1 && has_direction(normal());
}

// An ellipse reaches as far along an axis as the vector of its radii's coordinates is long.
Aabb Disk::bounds() const {
  Aabb box;
  if (!can_be_hit()) return box;
  for (int axis = 0; axis < 3; ++axis) {
    const double middle{center[axis]}, u{radius_u[axis]}, v{radius_v[axis]};
    const double reach = std::sqrt(u * u + v * v);
    const double error = gamma<double>(32) * (std::fabs(middle) + reach);
    box.lower[axis] = rounded_down(middle - reach - error);
    box.upper[axis] = -rounded_down(-(middle + reach + error));
  }
  return box;
}

std::optional<Disk::Hit> Disk::intersect(const ObjectRay& ray) const {
  const Vec3d u(radius_u), v(radius_v), n = normal();
  const Vec3d to_center = Vec3d(center) - ray.origin;
  const double height = dot(n, to_center);
  if (!(std::fabs(height) > gamma<double>(8) * dot(abs(n), abs(to_center)))) return std::nullopt;
  const double t = height / dot(n, ray.direction);
  if (!(t > 0 && std::isfinite(t))) return std::nullopt;
  const Vec3d from_center = t * ray.direction - to_center;
  const double scale = 1 / dot(n, n);
  const double along_u = dot(cross(from_center, v), n) * scale;
  const double along_v = dot(cross(u, from_center), n) * scale;
  const double r2 = along_u * along_u + along_v * along_v;
  if (!(r2 <= 1 && r2 >= double{inner} * double{inner})) return std::nullopt;
  return Hit{t, along_u, along_v};
}

ObjectPointOf<float> Disk::point(const ObjectRay& ray) const {
  const auto hit = intersect(ray);
  const double along_u = hit ? hit->along_u : 0, along_v = hit ? hit->along_v : 0;
  const Vec3d middle(center), u = along_u * Vec3d(radius_u), v = along_v * Vec3d(radius_v);
  const double r = std::sqrt(along_u * along_u + along_v * along_v);

  ObjectPointOf<float> point;
  point.position = middle + u + v;
  point.terms = abs(middle) + abs(u) + abs(v);
  point.geometric_normal = (flipped ? -1.0 : 1.0) * normal();
  point.shading_normal = {};
  point.uv = {turns_of(static_cast<float>(along_u), static_cast<float>(along_v)),
              static_cast<float>((1 - r) / (1 - double{inner}))};
  return point;
}

WideDerivatives Disk::derivatives(Vec2 uv) const {
  const auto [sine, cosine] = sin_cos_turns(uv.x);
  const double s{sine}, c{cosine}, width = 1 - double{inner};
  const double r = 1 - double{uv.y} * width;
  const Vec3d u(radius_u), v(radius_v);
  return {2 * std::numbers::pi * r * (c * v - s * u), -width * (c * u + s * v)};
}

RingPoint sample_ring(float inner, Vec2 u) {
  const float r = std::sqrt(inner * inner + u.x * (1 - inner * inner));
  const auto [sine, cosine] = sin_cos_turns(u.y);
  return {r * cosine, r * sine, {u.y, (1 - r) / (1 - inner)}};
}

}  // namespace tessera::core
