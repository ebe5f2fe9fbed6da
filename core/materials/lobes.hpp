// SPDX-License-Identifier: Apache-2.0
// The lobes of which layered materials consist. Each scatters white light; a LobeMixture gives it colour and
// the light that the layers above it let through. Directions as in bsdf.hpp, with +x along dp/du.
//
// evaluate(wo, wi, diffuse_cos) returns BSDF times cosine and the density with which sample(wo, u, u_lobe)
// generates wi. The samples of delta lobes have a weight; the others are weighed by the mixture.
// albedo(cos_o) is the scattered share of light from everywhere, for sampling and for the layers below.
#pragma once

#include <array>
#include <cmath>
#include <optional>

#include "core/materials/anisotropic_ggx.hpp"
#include "core/materials/bsdf_sample.hpp"
#include "core/materials/directional_albedo.hpp"
#include "core/materials/fresnel.hpp"
#include "core/materials/microfacet.hpp"
#include "core/materials/rough_dielectric.hpp"
#include "core/materials/smooth_dielectric.hpp"
#include "core/materials/thin_film.hpp"

namespace tessera::core {

// What the lobes have in common unless they say otherwise.
struct RoughLobe {
  static constexpr bool kIsDiffuse = false;  // whether diffuse_cos is its cosine
  bool is_delta() const { return false; }
  bool transmits() const { return false; }
  std::array<std::optional<BsdfSample>, 2> delta_branches(Vec3) const { return {}; }
};

// Diffuse reflection from a rough surface without loss of energy (Portsmouth, Kutz and Hill 2025).
struct DiffuseLobe : RoughLobe {
  static constexpr bool kIsDiffuse = true;

  DiffuseLobe(Rgb reflectance, float oren_nayar_roughness);
  BsdfValue evaluate(Vec3 wo, Vec3 wi, float diffuse_cos) const;
  std::optional<BsdfSample> sample(Vec3 wo, Vec2 u, float u_lobe) const;
  float albedo(float) const { return max_component(color); }

  Rgb color;
  float roughness;  // in [0, 1]; 0 is Lambert's

 private:
  Rgb multiple_scattering;  // its colour
};

// Even transmission to the other side.
struct DiffuseTransmissionLobe : RoughLobe {
  bool transmits() const { return true; }
  BsdfValue evaluate(Vec3 wo, Vec3 wi, float diffuse_cos) const;
  std::optional<BsdfSample> sample(Vec3 wo, Vec2 u, float u_lobe) const;
  float albedo(float) const { return 1; }
};

// Diffuse reflection from under a dielectric boundary, with the light that the boundary throws back down.
struct CoveredDiffuseLobe : RoughLobe {
  static constexpr bool kIsDiffuse = true;

  // `nonlinear` as in Plastic. alpha is the boundary's roughness.
  CoveredDiffuseLobe(Rgb reflectance, float eta, float alpha, bool nonlinear);
  BsdfValue evaluate(Vec3 wo, Vec3 wi, float diffuse_cos) const;
  std::optional<BsdfSample> sample(Vec3 wo, Vec2 u, float u_lobe) const;
  float albedo(float cos_o) const { return transmitted(cos_o) * mean_transmitted_ * max_component(color_); }

 private:
  float transmitted(float cosine) const;

  Rgb color_;  // of what leaves, over eta^2
  float eta_, alpha_, mean_transmitted_;
};

// Backscattering of cloth and dust: fibres along the normal (Estevez and Kulla 2017), with the visibility of
// Neubelt and Pettineo 2013.
struct SheenLobe : RoughLobe {
  explicit SheenLobe(float sheen_roughness);
  BsdfValue evaluate(Vec3 wo, Vec3 wi, float diffuse_cos) const;
  std::optional<BsdfSample> sample(Vec3 wo, Vec2 u, float u_lobe) const;
  float albedo(float cos_o) const;

  float roughness;  // alpha is its square
};

// Fresnel reflectances, by the cosine to the facet; `normal` is that at normal incidence.
struct DielectricReflectance {
  Rgb operator()(float cos_i) const { return Rgb::gray(fresnel_dielectric(cos_i, eta)); }
  Rgb normal() const {
    const float r = (eta - 1) / (eta + 1);
    return Rgb::gray(r * r);
  }

  float eta;
};

// A metal by its exact indices.
struct ConductorReflectance {
  Rgb operator()(float cos_i) const { return fresnel_conductor(cos_i, eta, k); }
  Rgb normal() const { return (*this)(1); }

  Rgb eta, k;
};

// A metal by its colours head-on and at 82 degrees (Kutz, Hasan and Edmondson 2021).
class EdgeTintReflectance {
 public:
  // `edge` is the colour at 82 degrees over that of Schlick's approximation.
  EdgeTintReflectance(Rgb f0, Rgb edge);
  Rgb operator()(float cos_i) const;
  Rgb normal() const { return f0_; }

 private:
  Rgb f0_, dip_;  // what is taken off at cos (1 - cos)^6
};

// Reflection by GGX microfacets, or by a mirror if `smooth`.
template <typename Reflectance>
struct GgxLobe {
  static constexpr bool kIsDiffuse = false;
  bool is_delta() const { return smooth; }
  bool transmits() const { return false; }
  BsdfValue evaluate(Vec3 wo, Vec3 wi, float diffuse_cos) const;
  std::optional<BsdfSample> sample(Vec3 wo, Vec2 u, float u_lobe) const;
  std::array<std::optional<BsdfSample>, 2> delta_branches(Vec3 wo) const;
  float albedo(float cos_o) const;

  Reflectance reflectance;
  AnisotropicGgx ggx;
  bool smooth;
  bool compensated;  // what is lost by single scattering is given back

 private:
  Rgb compensation(float cos_o) const;
};

template <>
float GgxLobe<DielectricReflectance>::albedo(float cos_o) const;
extern template struct GgxLobe<DielectricReflectance>;
extern template struct GgxLobe<ConductorReflectance>;
extern template struct GgxLobe<EdgeTintReflectance>;
extern template struct GgxLobe<FilmReflectance>;

// A dielectric boundary that reflects and transmits, without loss: what single scattering loses is given back
// to both.
class GlassLobe {
 public:
  static constexpr bool kIsDiffuse = false;

  // eta of the far side over the near side; smooth if alpha is below kMinAlpha, or eta close to 1.
  GlassLobe(float eta, float alpha, Rgb reflectance, Rgb transmittance);
  bool is_delta() const { return is_smooth_; }
  bool transmits() const { return !is_smooth_; }
  float eta() const { return rough_.eta; }
  BsdfValue evaluate(Vec3 wo, Vec3 wi, float diffuse_cos) const;
  std::optional<BsdfSample> sample(Vec3 wo, Vec2 u, float u_lobe) const;
  std::array<std::optional<BsdfSample>, 2> delta_branches(Vec3 wo) const;
  float albedo(float) const { return 1; }

 private:
  SmoothDielectricBsdf smooth_;
  RoughDielectricBsdf rough_;
  bool is_smooth_;
};

// A sheet of a dielectric, with all reflections between its sides: light leaves it unrefracted (Born and Wolf
// 1999, section 7.6, without interference).
struct ThinGlassLobe {
  static constexpr bool kIsDiffuse = false;
  bool is_delta() const { return smooth; }
  bool transmits() const { return !smooth; }
  BsdfValue evaluate(Vec3 wo, Vec3 wi, float diffuse_cos) const;
  std::optional<BsdfSample> sample(Vec3 wo, Vec2 u, float u_lobe) const;
  std::array<std::optional<BsdfSample>, 2> delta_branches(Vec3 wo) const;
  float albedo(float) const { return 1; }

  float eta;
  AnisotropicGgx ggx;
  bool smooth;
  Rgb reflectance, transmittance;  // tints

 private:
  float reflected(float cos_i) const {
    const float one_side = fresnel_dielectric(cos_i, eta);
    return 2 * one_side / (1 + one_side);
  }
};

}  // namespace tessera::core
