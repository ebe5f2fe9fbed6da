// Three doubles, for the few lines of geometry whose intermediate results floats cannot hold. Data stay
// floats.
#pragma once

#include <cmath>

#include "core/math/vec3.hpp"

namespace tessera::core {

struct Vec3d {
  double x = 0, y = 0, z = 0;

  Vec3d() = default;
  Vec3d(double x_value, double y_value, double z_value) : x(x_value), y(y_value), z(z_value) {}
  explicit Vec3d(Vec3 v) : x(v.x), y(v.y), z(v.z) {}

  double operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  Vec3 rounded() const { return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)}; }
};

inline Vec3d operator+(Vec3d a, Vec3d b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vec3d operator-(Vec3d a, Vec3d b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vec3d operator*(double s, Vec3d a) {
  return {s * a.x, s * a.y, s * a.z};
}
inline double dot(Vec3d a, Vec3d b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vec3d cross(Vec3d a, Vec3d b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(Vec3d a) {
  return std::sqrt(dot(a, a));
}
inline Vec3d abs(Vec3d a) {
  return {std::fabs(a.x), std::fabs(a.y), std::fabs(a.z)};
}

// Not zero, and everywhere finite: fit to be normalised.
inline bool has_direction(Vec3d a) {
  const double squared = dot(a, a);
  return squared > 0 && std::isfinite(squared);
}

}  // namespace tessera::core
