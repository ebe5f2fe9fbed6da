#include "core/geometry/sphere.hpp"

#include <cmath>

#include "core/geometry/rounding.hpp"
#include "core/math/elementary.hpp"

namespace tessera::core {

// Haines, Guenther and Akenine-Moeller 2019: the discriminant from the centre's distance to the line, which
// does not cancel for small and distant spheres, and roots without cancellation (Press et al. 2007,
// eq. 5.6.4).
std::optional<double> intersect_sphere(const ObjectRay& ray, const Sphere& sphere) {
  const Vec3d d = ray.direction;
  const Vec3d f = ray.origin - Vec3d(sphere.center);
  const double r2 = static_cast<double>(sphere.radius) * static_cast<double>(sphere.radius);
  const double a = dot(d, d), b = -dot(f, d), ff = dot(f, f);
  const Vec3d closest = f + (b / a) * d;
  const double discriminant = r2 - dot(closest, closest);
  if (!(discriminant >= 0) || !can_be_hit(sphere)) return std::nullopt;

  const double q = b + std::copysign(std::sqrt(a * discriminant), b);
  const double c = ff - r2, c_error = gamma<double>(8) * (ff + r2);
  if (c > c_error) {  // outside
    if (!(b > 0)) return std::nullopt;
    return c / q;
  }
  if (c < -c_error) return b > 0 ? q / a : c / q;                        // inside
  if (!(b > gamma<double>(8) * std::sqrt(ff * a))) return std::nullopt;  // on it, leaving or tangent
  return q / a;
}

Vec2 sphere_uv(Vec3 normal) {
  constexpr float kInvPi = 1 / kPi;
  const float longitude = 0.5f * kInvPi * atan2(-normal.z, normal.x);
  const float u = longitude < 0 ? longitude + 1 : longitude;
  const float equatorial = std::sqrt(normal.x * normal.x + normal.z * normal.z);
  const float v = 0.5f + kInvPi * atan2(normal.y, equatorial);
  return {u < 1 ? u : 0, v < 0 ? 0 : v > 1 ? 1 : v};
}

Tangents sphere_tangents(Vec3 normal) {
  const Vec3 east{normal.z, 0, -normal.x};  // +y x normal
  const float equatorial = length(east);
  if (!(equatorial > 0)) return {};
  return {east / equatorial, cross(normal, east / equatorial)};
}

}  // namespace tessera::core
