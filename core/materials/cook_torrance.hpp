// Reflection by GGX microfacets over a diffuse part (Cook and Torrance 1982; Walter et al. 2007).
#pragma once

#include <optional>

#include "core/materials/bsdf_sample.hpp"
#include "core/materials/material.hpp"
#include "core/materials/microfacet.hpp"

namespace tessera::core {

struct CookTorranceBsdf {
  static constexpr bool kIsDelta = false;

  BsdfValue evaluate(Vec3 wo_local, Vec3 wi_local) const;
  std::optional<BsdfSample> sample(Vec3 wo_local, Vec2 u, float u_lobe) const;

  Rgb diffuse, specular;  // diffuse + specular <= 1
  Rgb f0;
  std::optional<ComplexIndex> metal;  // instead of f0
  Ggx ggx;
  Masking masking;
  bool sample_half_vector;  // else visible normals

 private:
  Rgb reflectance(float cos_oh) const;
  float specular_probability(float cos_o) const;
  float masking_over_4_cos(float cos_o, float cos_i) const;
};

}  // namespace tessera::core
