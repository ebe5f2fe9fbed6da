// SPDX-License-Identifier: Apache-2.0
// Modified Phong: a diffuse part and a specular lobe around the mirror direction (Lafortune and Willems
// 1994). T is float for one point, or FloatN for one in each lane.
#pragma once

#include "core/materials/bsdf_sample.hpp"
#include "core/materials/material.hpp"
#include "core/math/simd_double.hpp"

namespace tessera::core::shading {

template <typename T>
struct PhongBsdfOf {
  MaskOf<T> is_delta() const { return false; }
  MaskOf<T> transmits() const { return false; }
  void scale_diffuse(T factor) { diffuse *= factor; }
  BsdfValueOf<T> evaluate(Vec3Of<T> wo_local, Vec3Of<T> wi_local, T diffuse_cos) const;
  BsdfSampleOf<T> sample(Vec3Of<T> wo_local, Vec2Of<T> u, T u_lobe) const;

  RgbOf<T> diffuse, specular;  // diffuse + specular <= 1, except after scale_diffuse
  T exponent{};
  MaskOf<T> n_plus_2{};  // PhongLobe::kNPlus2

 private:
  T highlight_probability() const;
  T sampled_exponent() const;
};
using PhongBsdf = PhongBsdfOf<float>;
extern template struct PhongBsdfOf<float>;
extern template struct PhongBsdfOf<FloatN>;

}  // namespace tessera::core::shading
