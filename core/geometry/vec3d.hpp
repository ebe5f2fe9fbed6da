// SPDX-License-Identifier: Apache-2.0
// Three doubles, for intermediate results that floats cannot hold. Data stay floats. Vec3dOf<DoubleN>
// (core/math/simd_double.hpp) and Vec3dOf<DoubleVector> hold vectors of them.
#pragma once

#include <cmath>
#include <limits>

#include "core/math/vec3.hpp"

namespace tessera::core {

template <typename D>
struct Vec3dOf {
  D x{}, y{}, z{};

  Vec3dOf() = default;
  Vec3dOf(D x_value, D y_value, D z_value) : x(x_value), y(y_value), z(z_value) {}
  template <typename T>
  explicit Vec3dOf(Vec3Of<T> v) : x(widened(v.x)), y(widened(v.y)), z(widened(v.z)) {}

  D operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  auto rounded() const { return Vec3Of<decltype(to_float(x))>{to_float(x), to_float(y), to_float(z)}; }

  friend Vec3dOf operator+(Vec3dOf a, Vec3dOf b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec3dOf operator-(Vec3dOf a, Vec3dOf b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec3dOf operator*(D s, Vec3dOf a) { return {s * a.x, s * a.y, s * a.z}; }
};
using Vec3d = Vec3dOf<double>;

template <typename D = double>
D dot(Vec3dOf<D> a, Vec3dOf<D> b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <typename D = double>
Vec3dOf<D> cross(Vec3dOf<D> a, Vec3dOf<D> b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <typename D = double>
D length(Vec3dOf<D> a) {
  using std::sqrt;
  return sqrt(dot(a, a));
}
template <typename D = double>
Vec3dOf<D> abs(Vec3dOf<D> a) {
  using std::fabs;
  return {fabs(a.x), fabs(a.y), fabs(a.z)};
}

template <typename Mask, typename D>
Vec3dOf<D> select(Mask mask, Vec3dOf<D> a, Vec3dOf<D> b) {
  return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}

// Non-zero and finite, so it can be normalised.
template <typename D = double>
auto has_direction(Vec3dOf<D> a) {
  const D squared = dot(a, a);
  return (squared > 0) & (squared < std::numeric_limits<double>::infinity());
}

}  // namespace tessera::core
