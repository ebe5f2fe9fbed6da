// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/triangle.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/rounding.hpp"

namespace tessera::core {
namespace {

double max_abs(double a, double b, double c) {
  return std::max({std::fabs(a), std::fabs(b), std::fabs(c)});
}

// a * b - c * d to within two units in the last place (Kahan; Jeannerod, Louvet and Muller 2013), so its
// sign is right and 0 is exact. Calls the fused operation explicitly rather than leave it to the compiler.
double difference_of_products(double a, double b, double c, double d) {
  const double cd = c * d;
  const double error_of_cd = std::fma(-c, d, cd);
  return std::fma(a, b, -cd) + error_of_cd;
}

// A bound on the error of the computed t times |det * direction_z| (Pharr et al. 2023, section 6.8.7, with
// the unit roundoff of double). a, b, c are the sheared corners, e the edge functions.
double t_error_bound(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& e) {
  const double max_x = max_abs(a.x, b.x, c.x), max_y = max_abs(a.y, b.y, c.y), max_z = max_abs(a.z, b.z, c.z);
  const double max_e = max_abs(e.x, e.y, e.z);
  const double delta_x = gamma<double>(5) * (max_x + max_z);
  const double delta_y = gamma<double>(5) * (max_y + max_z);
  const double delta_z = gamma<double>(3) * max_z;
  const double delta_e = 2 * (gamma<double>(2) * max_x * max_y + delta_y * max_x + delta_x * max_y);
  return 3 * (gamma<double>(3) * max_e * max_z + delta_e * max_z + delta_z * max_e);
}

}  // namespace

std::optional<TriangleHit> intersect_triangle(const ShearedRay& ray, const TriangleCorners& corners) {
  const Vec3d a = ray.shear(corners[0]), b = ray.shear(corners[1]), c = ray.shear(corners[2]);
  const Vec3d e(difference_of_products(b.x, c.y, b.y, c.x), difference_of_products(c.x, a.y, c.y, a.x),
                difference_of_products(a.x, b.y, a.y, b.x));
  if ((e.x < 0 || e.y < 0 || e.z < 0) && (e.x > 0 || e.y > 0 || e.z > 0)) return std::nullopt;
  const double det = e.x + e.y + e.z;
  if (det == 0) return std::nullopt;

  const double scale = det * ray.direction_z;
  const double scaled_t = e.x * a.z + e.y * b.z + e.z * c.z;
  const double t = scaled_t / scale;
  // If all corners are ahead, so is every point between them. The comparison of t also rejects NaN, which
  // only non-finite rays and corners produce.
  const bool all_ahead = ray.direction_z > 0 ? std::min({a.z, b.z, c.z}) > 0 : std::max({a.z, b.z, c.z}) < 0;
  const double t_error = all_ahead ? 0 : t_error_bound(a, b, c, e) / std::fabs(scale);
  if (!(t > t_error)) return std::nullopt;
  return TriangleHit{static_cast<float>(t), static_cast<float>(e.y / det), static_cast<float>(e.z / det)};
}

Vec3d area_normal(const TriangleCorners& corners) {
  const Vec3d p0(corners[0]);
  return cross(Vec3d(corners[1]) - p0, Vec3d(corners[2]) - p0);
}

}  // namespace tessera::core
