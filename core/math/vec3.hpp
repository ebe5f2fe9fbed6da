// SPDX-License-Identifier: Apache-2.0
// Three floats: a point, a direction or a normal; the variable's name says which, and in which space.
// Vec3Of<FloatN> (core/math/simd.hpp) holds a vector of them.
#pragma once

#include <cmath>

#include "core/math/lanes.hpp"

namespace tessera::core {

template <typename T>
struct Vec3Of {
  T x{}, y{}, z{};

  T& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
  T operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  Vec3Of& operator+=(Vec3Of b) { return *this = *this + b; }
  bool operator==(const Vec3Of&) const = default;

  friend Vec3Of operator+(Vec3Of a, Vec3Of b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec3Of operator-(Vec3Of a, Vec3Of b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec3Of operator-(Vec3Of a) { return {-a.x, -a.y, -a.z}; }
  friend Vec3Of operator*(Vec3Of a, T s) { return {a.x * s, a.y * s, a.z * s}; }
  friend Vec3Of operator*(T s, Vec3Of a) { return a * s; }
  friend Vec3Of operator/(Vec3Of a, T s) { return {a.x / s, a.y / s, a.z / s}; }
};
using Vec3 = Vec3Of<float>;

// `v` in each lane.
template <typename T>
Vec3Of<T> broadcast(Vec3 v) {
  return {v.x, v.y, v.z};
}

template <typename T = float>
T dot(Vec3Of<T> a, Vec3Of<T> b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <typename T = float>
Vec3Of<T> cross(Vec3Of<T> a, Vec3Of<T> b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <typename T = float>
T length_squared(Vec3Of<T> a) {
  return dot(a, a);
}
template <typename T = float>
T length(Vec3Of<T> a) {
  using std::sqrt;
  return sqrt(dot(a, a));
}
template <typename T = float>
Vec3Of<T> normalize(Vec3Of<T> a) {
  return a / length(a);
}

template <typename T = float>
Vec3Of<T> abs(Vec3Of<T> a) {
  using std::fabs;
  return {fabs(a.x), fabs(a.y), fabs(a.z)};
}
inline Vec3 min(Vec3 a, Vec3 b) {
  return {a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y, a.z < b.z ? a.z : b.z};
}
inline Vec3 max(Vec3 a, Vec3 b) {
  return {a.x > b.x ? a.x : b.x, a.y > b.y ? a.y : b.y, a.z > b.z ? a.z : b.z};
}
inline bool is_finite(Vec3 a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}
template <typename T>
Vec3Of<T> select(MaskOf<T> mask, Vec3Of<T> a, Vec3Of<T> b) {
  return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}

// `v` or `-v`, whichever lies in the hemisphere of `reference`.
template <typename T = float>
Vec3Of<T> face_toward(Vec3Of<T> v, Vec3Of<T> reference) {
  return select(dot(v, reference) < 0, -v, v);
}

template <typename T>
struct Vec2Of {
  T x{}, y{};
  bool operator==(const Vec2Of&) const = default;

  friend Vec2Of operator+(Vec2Of a, Vec2Of b) { return {a.x + b.x, a.y + b.y}; }
  friend Vec2Of operator-(Vec2Of a, Vec2Of b) { return {a.x - b.x, a.y - b.y}; }
  friend Vec2Of operator*(Vec2Of a, T s) { return {a.x * s, a.y * s}; }
};
using Vec2 = Vec2Of<float>;

}  // namespace tessera::core
