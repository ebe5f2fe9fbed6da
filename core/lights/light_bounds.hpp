// SPDX-License-Identifier: Apache-2.0
// Spatial, directional and power bounds of a set of lights, from which the contribution of the set to a
// point is estimated (Conty Estevez and Kulla 2018, section 3).
#pragma once

#include "core/geometry/aabb.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core::lights {

// Directions within an angle theta_o of an axis, which bound the normals of the lights. At most a
// hemisphere, or all directions.
struct NormalCone {
  Vec3 axis{0, 0, 1};  // unit
  float cos_o = 1, sin_o = 0;

  static NormalCone only(Vec3 direction) { return {direction}; }
  static NormalCone all() { return {{0, 0, 1}, -1, 0}; }
  // From 1 - cos(theta_o), which is at most 1.
  static NormalCone around(Vec3 axis, float one_minus_cos);

  bool is_all() const { return cos_o < 0; }
};

// The emission at an angle t from the nearest direction of the cone: cos(t) up to theta_e.
struct Falloff {
  float cos_e;
  float spread;  // theta_e + sin(theta_e) cos(theta_e)

  static Falloff cosine() { return {0, 1.57079632679489661923f}; }  // up to a right angle, as for surfaces
  static Falloff none() { return {1, 0}; }                          // nothing beyond the cone
};

// Spatial bounds of lights.
struct Extent {
  Aabb box;
  double area = 0;  // sum over the set of each light's largest projected area
};

class LightBounds {
 public:
  // Bounds of no lights.
  LightBounds() = default;
  // `intensity` is in watts per steradian in the directions of `normals`, averaged over the channels.
  // Two-sided lights emit equally on both sides.
  LightBounds(const Extent& extent, const NormalCone& normals, Falloff falloff, double intensity,
              bool two_sided);

  // Extends the bounds by the other's lights.
  void include(const LightBounds& other);

  const Aabb& box() const { return extent_.box; }
  double area() const { return extent_.area; }
  const NormalCone& normals() const { return normals_; }
  float cos_e() const { return falloff_.cos_e; }
  bool two_sided() const { return two_sided_; }
  // Watts.
  double power() const { return power_; }
  // Mean over the set of the power per solid angle that it is emitted into: watts per steradian in the
  // directions of normals().
  double intensity() const;
  // The integral of the falloff over directions, for one side: from pi for a flat light to 4 pi (Conty
  // Estevez and Kulla 2018, section 4.4).
  double orientation_measure() const;

 private:
  Extent extent_;
  NormalCone normals_;
  Falloff falloff_ = Falloff::none();
  bool two_sided_ = false;
  double power_ = 0;
};

}  // namespace tessera::core::lights
