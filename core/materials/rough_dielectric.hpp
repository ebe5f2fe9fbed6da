// SPDX-License-Identifier: Apache-2.0
// A dielectric boundary of GGX microfacets, each a smooth boundary (Walter et al. 2007).
#pragma once

#include <optional>

#include "core/materials/bsdf_sample.hpp"
#include "core/materials/fresnel.hpp"
#include "core/materials/microfacet.hpp"

namespace tessera::core {

struct RoughDielectricBsdf {
  static constexpr bool kIsDelta = false;

  void scale_diffuse(float) {}
  BsdfValue evaluate(Vec3 wo_local, Vec3 wi_local, float diffuse_cos) const;
  std::optional<BsdfSample> sample(Vec3 wo_local, Vec2 u, float u_lobe) const;

  Ggx ggx;
  float eta;  // of the far side over the near side; must not be 1
  DielectricFresnel fresnel;
  Rgb reflectance, transmittance;

 private:
  BsdfValue evaluate_reflection(Vec3 wo_local, Vec3 wi_local) const;
  BsdfValue evaluate_transmission(Vec3 wo_local, Vec3 wi_local) const;
  float solid_angle_ratio(float cos_oh, float cos_ih) const;
};

}  // namespace tessera::core
