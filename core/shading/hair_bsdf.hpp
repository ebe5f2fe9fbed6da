// SPDX-License-Identifier: Apache-2.0
// Scattering by a hair, a cylinder of a dielectric with pigment inside (Chiang et al. 2016, after Marschner
// et al. 2003 and d'Eon et al. 2011, in the form of Pharr et al. 2023, section 9.9). It has four lobes:
// reflection, transmission, one reflection inside, and all that follow. Each is a product of a longitudinal
// part M, an attenuation A and an azimuthal part N. Directions as in bsdf.hpp; the value includes the cosine,
// which cancels. T is float for one point, or FloatN for one in each lane.
#pragma once

#include <array>

#include "core/materials/bsdf_sample.hpp"
#include "core/materials/model_at.hpp"

namespace tessera::core::shading {

template <typename T>
class HairBsdfOf {
 public:
  HairBsdfOf() = default;
  // v of the first set tells how far from the axis the ray meets the hair, from 0 to 1 across it.
  explicit HairBsdfOf(const ModelAt<T, Hair>& model);

  // The direction of the hair, perpendicular to the normal but for rounding.
  void orient(Vec3Of<T> tangent_local);
  MaskOf<T> is_delta() const { return false; }
  MaskOf<T> transmits() const { return true; }
  T transmitted_eta() const { return T(1.0f); }
  void scale_diffuse(T) {}
  BsdfValueOf<T> evaluate(Vec3Of<T> wo_local, Vec3Of<T> wi_local, T diffuse_cos) const;
  BsdfSampleOf<T> sample(Vec3Of<T> wo_local, Vec2Of<T> u, T u_lobe) const;

 private:
  using Real = WideOf<T>;
  static constexpr std::size_t kLobes = 4;  // R, TT, TRT and the rest

  // A direction by the hair's axis: sine and cosine of the inclination, and the azimuth.
  struct Inclined {
    Real sine, cosine, azimuth;
  };
  // What depends on the viewer.
  struct Viewed {
    std::array<RgbOf<T>, kLobes> attenuations;
    std::array<Real, kLobes> chances;
    std::array<Real, kLobes> sines, cosines;  // of the inclination that a lobe scatters from, tilted
    Real azimuth, refracted_offset;           // of the viewer; of the ray inside, as an angle
  };
  // The lobe of a sample.
  struct Chosen {
    MaskOf<T> is_last;
    Real u;  // a number in [0, 1] that is left
    Real inverse_variance, sine, cosine, turn;
  };

  void set_longitudinal(Real beta_m);
  void set_azimuthal(Real beta_n);
  void set_tilts(T degrees);
  Inclined incline(Vec3Of<T> w) const;
  Viewed view(Vec3Of<T> wo) const;
  void attenuate(const Inclined& wo, Viewed& viewed) const;
  void tilt(const Inclined& wo, Viewed& viewed) const;
  Real longitudinal(std::size_t lobe, const Viewed& viewed, const Inclined& wi) const;
  Real azimuthal(std::size_t lobe, const Viewed& viewed, Real wi_azimuth) const;
  // The azimuth by which a lobe turns light.
  Real turn(std::size_t lobe, const Viewed& viewed) const;
  BsdfValueOf<T> evaluate(const Viewed& viewed, Vec3Of<T> wi) const;
  Chosen choose(const Viewed& viewed, T u_lobe) const;
  Inclined sample_lobe(const Chosen& lobe, const Viewed& viewed, Vec2Of<T> u) const;

  Vec3Of<T> axis_{T(1.0f), T(0.0f), T(0.0f)}, side_{T(0.0f), T(-1.0f), T(0.0f)},
      normal_{T(0.0f), T(0.0f), T(1.0f)};  // right-handed
  Real offset_, offset_angle_;             // h and its arc sine
  Real eta_;
  RgbOf<T> absorption_;
  std::array<Real, kLobes> inverse_variances_, norms_;  // of M
  Real logistic_scale_, logistic_norm_, logistic_start_;
  std::array<Real, 3> tilt_sines_, tilt_cosines_;  // of the scales' tilt times 1, 2 and 4
};
extern template class HairBsdfOf<float>;
extern template class HairBsdfOf<FloatN>;

}  // namespace tessera::core::shading
