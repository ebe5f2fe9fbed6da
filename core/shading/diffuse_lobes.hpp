// SPDX-License-Identifier: Apache-2.0
// Lobes (lobe.hpp) of light that has lost its direction: diffuse reflection and transmission, and sheen.
#pragma once

#include "core/materials/microfacets.hpp"
#include "core/shading/lobe.hpp"

namespace tessera::core::shading {

// Diffuse reflection from a rough surface without loss of energy (Portsmouth, Kutz and Hill 2025).
template <typename T>
struct DiffuseLobe : RoughLobe<T> {
  static constexpr bool kIsDiffuse = true;

  DiffuseLobe() = default;
  DiffuseLobe(RgbOf<T> reflectance, T oren_nayar_roughness);
  BsdfValueOf<T> evaluate(Vec3Of<T> wo, Vec3Of<T> wi, T diffuse_cos) const;
  BsdfSampleOf<T> sample(Vec3Of<T> wo, Vec2Of<T> u, T u_lobe) const;
  T albedo(T) const { return max_component(color); }

  RgbOf<T> color;
  T roughness{};  // in [0, 1]; 0 is Lambert's

 private:
  RgbOf<T> multiple_scattering;  // its colour
};

// Even transmission to the other side.
template <typename T>
struct DiffuseTransmissionLobe : RoughLobe<T> {
  MaskOf<T> transmits() const { return true; }
  BsdfValueOf<T> evaluate(Vec3Of<T> wo, Vec3Of<T> wi, T diffuse_cos) const;
  BsdfSampleOf<T> sample(Vec3Of<T> wo, Vec2Of<T> u, T u_lobe) const;
  T albedo(T) const { return T(1.0f); }
};

// Diffuse reflection from under a dielectric boundary, with the light that the boundary reflects internally.
template <typename T>
struct CoveredDiffuseLobe : RoughLobe<T> {
  static constexpr bool kIsDiffuse = true;

  CoveredDiffuseLobe() = default;
  // The dielectric boundary above.
  struct Boundary {
    MicrofacetKind facets{};  // in all lanes
    T alpha{};                // 0 if smooth
    T eta = T(1.0f);
    T internal_reflection = T(1.0f);  // as in Plastic
  };
  // `nonlinear` and `compensated` as in Plastic.
  CoveredDiffuseLobe(RgbOf<T> reflectance, const Boundary& boundary, MaskOf<T> nonlinear,
                     MaskOf<T> compensated);
  BsdfValueOf<T> evaluate(Vec3Of<T> wo, Vec3Of<T> wi, T diffuse_cos) const;
  BsdfSampleOf<T> sample(Vec3Of<T> wo, Vec2Of<T> u, T u_lobe) const;
  T albedo(T cos_o) const { return transmitted(cos_o) * mean_transmitted_ * max_component(color_); }

 private:
  T transmitted(T cosine) const;

  RgbOf<T> color_;  // of what leaves, over eta^2
  Boundary boundary_;
  T mean_transmitted_{};
};

// Backscattering of cloth and dust: fibres along the normal (Estevez and Kulla 2017), with the visibility of
// Neubelt and Pettineo 2013.
template <typename T>
struct SheenLobe : RoughLobe<T> {
  SheenLobe() = default;
  explicit SheenLobe(T sheen_roughness);
  BsdfValueOf<T> evaluate(Vec3Of<T> wo, Vec3Of<T> wi, T diffuse_cos) const;
  BsdfSampleOf<T> sample(Vec3Of<T> wo, Vec2Of<T> u, T u_lobe) const;
  T albedo(T cos_o) const;

  T roughness = T(1.0f);  // alpha is its square
};

extern template struct DiffuseLobe<float>;
extern template struct DiffuseLobe<FloatN>;
extern template struct DiffuseTransmissionLobe<float>;
extern template struct DiffuseTransmissionLobe<FloatN>;
extern template struct CoveredDiffuseLobe<float>;
extern template struct CoveredDiffuseLobe<FloatN>;
extern template struct SheenLobe<float>;
extern template struct SheenLobe<FloatN>;

}  // namespace tessera::core::shading
