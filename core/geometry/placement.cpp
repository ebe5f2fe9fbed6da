// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/placement.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/geometry/rounding.hpp"

namespace tessera::core {
namespace {

constexpr double kMaxScale = 1e15;

double largest(Vec3d v) {
  return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
}

// Rounds outwards by the given error, to float.
float below(double value, double error) {
  return next_float_down(static_cast<float>(value - error));
}
float above(double value, double error) {
  return next_float_up(static_cast<float>(value + error));
}

}  // namespace

// The axes are floats, so the products in their cross products are exact and those have full accuracy.
Placement::Placement(const Transform& to_world) {
  map_.x_axis = Vec3d(to_world.x_axis);
  map_.y_axis = Vec3d(to_world.y_axis);
  map_.z_axis = Vec3d(to_world.z_axis);
  map_.origin = Vec3d(to_world.origin);
  const Vec3d yz = cross(map_.y_axis, map_.z_axis), zx = cross(map_.z_axis, map_.x_axis),
              xy = cross(map_.x_axis, map_.y_axis);
  const double inverse_determinant = 1 / dot(map_.x_axis, yz);
  map_.inverse_x = inverse_determinant * yz;
  map_.inverse_y = inverse_determinant * zx;
  map_.inverse_z = inverse_determinant * xy;
}

bool Placement::can_place(const Transform& t) {
  if (!is_finite(t.x_axis) || !is_finite(t.y_axis) || !is_finite(t.z_axis) || !is_finite(t.origin))
    return false;
  const Vec3d x(t.x_axis), y(t.y_axis), z(t.z_axis);
  constexpr double kMinAngle = 1e-9;  // lower bound on the angle between an axis and the plane of the others
  const double determinant = dot(x, cross(y, z));
  if (!(std::fabs(determinant) > kMinAngle * length(x) * length(y) * length(z))) return false;
  const Placement placed(t);
  return std::max({largest(x), largest(y), largest(z)}) <= kMaxScale &&
         std::max({largest(placed.map_.inverse_x), largest(placed.map_.inverse_y),
                   largest(placed.map_.inverse_z)}) <= kMaxScale;
}

ObjectRay Placement::to_object(const Ray& ray) const {
  return {object_point(Vec3d(ray.origin)), object_vector(Vec3d(ray.direction)), ray.t_max, ray.time};
}

Aabb Placement::bounds(const Aabb& box) const {
  const Vec3d lower(box.lower), upper(box.upper);
  const Vec3d center = point(0.5 * (lower + upper)), half = 0.5 * (upper - lower);
  const Vec3d reach = half.x * abs(map_.x_axis) + half.y * abs(map_.y_axis) + half.z * abs(map_.z_axis);
  const Vec3d farthest(max(abs(box.lower), abs(box.upper)));
  const Vec3d error = gamma<double>(32) * error_terms(farthest);
  return {{below(center.x - reach.x, error.x), below(center.y - reach.y, error.y),
           below(center.z - reach.z, error.z)},
          {above(center.x + reach.x, error.x), above(center.y + reach.y, error.y),
           above(center.z + reach.z, error.z)}};
}

float uniform_scale(const Transform& t, float tolerance) {
  const Vec3 s = t.scales();
  const float length_tolerance = tolerance * s.x, angle_tolerance = length_tolerance * s.x;
  const bool is_round = std::fabs(s.y - s.x) <= length_tolerance &&
                        std::fabs(s.z - s.x) <= length_tolerance &&
                        std::fabs(dot(t.x_axis, t.y_axis)) <= angle_tolerance &&
                        std::fabs(dot(t.y_axis, t.z_axis)) <= angle_tolerance &&
                        std::fabs(dot(t.z_axis, t.x_axis)) <= angle_tolerance;
  return is_round ? s.x : 0;
}

}  // namespace tessera::core
