// SPDX-License-Identifier: Apache-2.0
// What is known of a set of lights as one: where they are, which way they shine and how strongly. From it
// follows how much light the set may send to a point (Conty Estevez and Kulla 2018, section 3).
#pragma once

#include "core/geometry/aabb.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core {

// Directions within an angle theta_o of an axis: those that lights of a set face. Up to a hemisphere, or all.
struct NormalCone {
  Vec3 axis{0, 0, 1};  // unit
  float cos_o = 1, sin_o = 0;

  static NormalCone only(Vec3 direction) { return {direction}; }
  static NormalCone all() { return {{0, 0, 1}, -1, 0}; }
  // By 1 - cos(theta_o), at most 1.
  static NormalCone around(Vec3 axis, float one_minus_cos);

  bool is_all() const { return cos_o < 0; }
};

// How light falls off with the angle t from the nearest direction of the cone: as cos(t) up to theta_e.
struct Falloff {
  float cos_e;
  float spread;  // theta_e + sin(theta_e) cos(theta_e)

  static Falloff cosine() { return {0, 1.57079632679489661923f}; }  // up to a right angle, as surfaces do
  static Falloff none() { return {1, 0}; }                          // nothing beyond the cone
};

// Where lights are.
struct Extent {
  Aabb box;
  double area = 0;  // as it is seen from where it is seen the largest, the sum over the set
};

class LightBounds {
 public:
  // Of no light.
  LightBounds() = default;
  // `intensity`: watts per steradian in the directions of `normals`, the mean of the channels. Two-sided
  // lights shine backwards as they do forwards.
  LightBounds(const Extent& extent, const NormalCone& normals, Falloff falloff, double intensity,
              bool two_sided);

  // Grows to bound the other's lights too.
  void include(const LightBounds& other);

  const Aabb& box() const { return extent_.box; }
  double area() const { return extent_.area; }
  const NormalCone& normals() const { return normals_; }
  float cos_e() const { return falloff_.cos_e; }
  bool two_sided() const { return two_sided_; }
  // Watts.
  double power() const { return power_; }
  // Power over the solid angle that it is sent into, in the mean over the set: watts per steradian in the
  // directions of normals().
  double intensity() const;
  // The integral of the falloff over directions, of one side: from pi for a flat light to 4 pi
  // (Conty Estevez and Kulla 2018, section 4.4).
  double orientation_measure() const;

 private:
  Extent extent_;
  NormalCone normals_;
  Falloff falloff_ = Falloff::none();
  bool two_sided_ = false;
  double power_ = 0;
};

}  // namespace tessera::core
