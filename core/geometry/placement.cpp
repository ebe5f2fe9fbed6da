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
Placement::Placement(const Transform& to_world)
    : x_axis_(to_world.x_axis), y_axis_(to_world.y_axis), z_axis_(to_world.z_axis), origin_(to_world.origin) {
  const Vec3d yz = cross(y_axis_, z_axis_), zx = cross(z_axis_, x_axis_), xy = cross(x_axis_, y_axis_);
  const double inverse_determinant = 1 / dot(x_axis_, yz);
  inverse_x_ = inverse_determinant * yz;
  inverse_y_ = inverse_determinant * zx;
  inverse_z_ = inverse_determinant * xy;
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
         std::max({largest(placed.inverse_x_), largest(placed.inverse_y_), largest(placed.inverse_z_)}) <=
             kMaxScale;
}

ObjectRay Placement::to_object(const Ray& ray) const {
  return {object_point(Vec3d(ray.origin)), object_vector(Vec3d(ray.direction)), ray.t_max};
}

Aabb Placement::bounds(const Aabb& box) const {
  const Vec3d lower(box.lower), upper(box.upper);
  const Vec3d center = point(0.5 * (lower + upper)), half = 0.5 * (upper - lower);
  const Vec3d reach = half.x * abs(x_axis_) + half.y * abs(y_axis_) + half.z * abs(z_axis_);
  const Vec3d farthest(max(abs(box.lower), abs(box.upper)));
  const Vec3d error = gamma<double>(32) * error_terms(farthest);
  return {{below(center.x - reach.x, error.x), below(center.y - reach.y, error.y),
           below(center.z - reach.z, error.z)},
          {above(center.x + reach.x, error.x), above(center.y + reach.y, error.y),
           above(center.z + reach.z, error.z)}};
}

// Let A be the map's matrix and B its computed inverse. A point x of the object becomes A x + o, and a ray
// that leaves it starts at B (A x + o - o) in the object. Each of these steps has an error of a few
// roundings of |A| |x| + |o| in the world, and so has B's difference from the inverse, except for a factor
// |A| |B|.
Vec3d Placement::error_terms(Vec3d terms) const {
  const auto magnitude = [this](Vec3d v) {
    return v.x * abs(x_axis_) + v.y * abs(y_axis_) + v.z * abs(z_axis_);
  };
  const Vec3d in_world = magnitude(terms) + abs(origin_);
  return magnitude(
      {dot(abs(inverse_x_), in_world), dot(abs(inverse_y_), in_world), dot(abs(inverse_z_), in_world)});
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
