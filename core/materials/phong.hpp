// SPDX-License-Identifier: Apache-2.0
// Modified Phong: a diffuse part and a specular lobe around the mirror direction (Lafortune and Willems
// 1994).
#pragma once

#include <optional>

#include "core/materials/bsdf_sample.hpp"
#include "core/materials/material.hpp"

namespace tessera::core {

struct PhongBsdf {
  static constexpr bool kIsDelta = false;

  void scale_diffuse(float factor) { diffuse *= factor; }
  BsdfValue evaluate(Vec3 wo_local, Vec3 wi_local, float diffuse_cos) const;
  std::optional<BsdfSample> sample(Vec3 wo_local, Vec2 u, float u_lobe) const;

  Rgb diffuse, specular;  // diffuse + specular <= 1, except after scale_diffuse
  float exponent;
  PhongLobe lobe;

 private:
  float highlight_probability() const;
  float sampled_exponent() const;
};

}  // namespace tessera::core
