// SPDX-License-Identifier: Apache-2.0
#include "core/lights/light_bounds.hpp"

#include <cmath>
#include <numbers>
#include <tuple>

namespace tessera::core::lights {
namespace {

// The unit vector perpendicular to `axis` on the side of `toward`; zero if they are parallel.
Vec3 perpendicular(Vec3 axis, Vec3 toward) {
  const Vec3 across = toward - axis * dot(axis, toward);
  const Vec3 exact =
      across - axis * dot(axis, across);  // removes the remainder along the axis that rounding leaves
  const float length2 = length_squared(exact);
  return length2 > 1e-13f ? exact / std::sqrt(length2) : Vec3{};
}

// Whether `outer`, the wider cone, contains `inner`: the angle between the axes is at most the difference
// of the cones' angles.
bool contains(const NormalCone& outer, const NormalCone& inner, float cos_between) {
  return cos_between >= outer.cos_o * inner.cos_o + outer.sin_o * inner.sin_o;
}

// The narrowest cone that contains both, or all directions if it exceeds a hemisphere.
NormalCone unite(const NormalCone& a, const NormalCone& b) {
  if (a.is_all() || b.is_all()) return NormalCone::all();
  const float cos_between = dot(a.axis, b.axis);
  const auto& [wider, narrower] = a.cos_o <= b.cos_o ? std::tie(a, b) : std::tie(b, a);
  if (contains(wider, narrower, cos_between)) return wider;
  // The outermost edges in the plane of both axes. Their bisector is the new axis.
  const Vec3 edge_a = a.axis * a.cos_o - perpendicular(a.axis, b.axis) * a.sin_o;
  const Vec3 edge_b = b.axis * b.cos_o - perpendicular(b.axis, a.axis) * b.sin_o;
  const Vec3 sum = edge_a + edge_b;
  constexpr float kMin = 1e-3f;  // near a hemisphere, rounding would determine the axis
  if (!(dot(sum, a.axis + b.axis) > kMin)) return NormalCone::all();
  const Vec3 axis = normalize(sum);
  const float cos_o = std::fmin(dot(axis, edge_a), dot(axis, edge_b));
  return cos_o > 0 ? NormalCone::around(axis, 1 - cos_o) : NormalCone::all();
}

}  // namespace

NormalCone NormalCone::around(Vec3 axis, float one_minus_cos) {
  return {axis, 1 - one_minus_cos, std::sqrt(std::fmax(0.0f, one_minus_cos * (2 - one_minus_cos)))};
}

LightBounds::LightBounds(const Extent& extent, const NormalCone& normals, Falloff falloff, double intensity,
                         bool two_sided)
    : extent_(extent), normals_(normals), falloff_(falloff), two_sided_(two_sided) {
  power_ = intensity * orientation_measure() * (two_sided ? 2 : 1);
}

void LightBounds::include(const LightBounds& other) {
  if (!(power_ > 0)) {
    *this = other;
    return;
  }
  if (!(other.power_ > 0)) return;
  extent_.box.include(other.extent_.box);
  extent_.area += other.extent_.area;
  two_sided_ = two_sided_ || other.two_sided_;
  NormalCone normals = other.normals_;
  if (two_sided_) normals.axis = face_toward(normals.axis, normals_.axis);
  normals_ = unite(normals_, normals);
  if (other.falloff_.cos_e < falloff_.cos_e) falloff_ = other.falloff_;
  power_ += other.power_;
}

double LightBounds::intensity() const {
  const double sides = two_sided_ && !normals_.is_all() ? 2 : 1;
  return power_ / (sides * orientation_measure());
}

double LightBounds::orientation_measure() const {
  if (normals_.is_all()) return 4 * std::numbers::pi;
  const auto cos_o = static_cast<double>(normals_.cos_o), sin_o = static_cast<double>(normals_.sin_o);
  const auto cos_e = static_cast<double>(falloff_.cos_e), spread = static_cast<double>(falloff_.spread);
  return std::numbers::pi * (2 * (1 - cos_o) + cos_o * (1 - cos_e * cos_e) + sin_o * spread);
}

}  // namespace tessera::core::lights
