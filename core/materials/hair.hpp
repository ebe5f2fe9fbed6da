// SPDX-License-Identifier: Apache-2.0
// Scattering by a hair, a cylinder of a dielectric with pigment inside (Chiang et al. 2016, after Marschner
// et al. 2003 and d'Eon et al. 2011, in the form of Pharr et al. 2023, section 9.9). It has four lobes:
// reflection, transmission, one reflection inside, and all that follow. Each is a product of a longitudinal
// part M, an attenuation A and an azimuthal part N. Directions as in bsdf.hpp; the value includes the cosine,
// which cancels.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/materials/bsdf_sample.hpp"
#include "core/materials/material.hpp"

namespace tessera::core {

// The absorption per hair radius that gives hair the reflectance `color` in thick hair, and its inverse
// (Chiang et al. 2016, equation 9).
Rgb hair_absorption(Rgb color, float beta_n);
Rgb hair_color(Rgb absorption, float beta_n);
// The absorption of a concentration of eumelanin (brown) and pheomelanin (red) (d'Eon et al. 2011).
Rgb melanin_absorption(float eumelanin, float pheomelanin);
// What the model absorbs at a point.
Rgb absorption_at(const Hair& model, const std::vector<Texture>& textures, const UvSets& uv);

class HairBsdf {
 public:
  // v of the first set tells how far from the axis the ray meets the hair, from 0 to 1 across it.
  HairBsdf(const Hair& model, const std::vector<Texture>& textures, const UvSets& uv);

  // The direction of the hair, perpendicular to the normal but for rounding.
  void orient(Vec3 tangent_local);
  bool is_delta() const { return false; }
  bool transmits() const { return true; }
  void scale_diffuse(float) {}
  BsdfValue evaluate(Vec3 wo_local, Vec3 wi_local, float diffuse_cos) const;
  std::optional<BsdfSample> sample(Vec3 wo_local, Vec2 u, float u_lobe) const;

 private:
  static constexpr std::size_t kLobes = 4;  // R, TT, TRT and the rest

  // A direction by the hair's axis: sine and cosine of the inclination, and the azimuth.
  struct Inclined {
    double sine, cosine, azimuth;
  };
  // What depends on the viewer.
  struct Viewed {
    std::array<Rgb, kLobes> attenuations;
    std::array<double, kLobes> chances;
    std::array<double, kLobes> sines, cosines;  // of the inclination that a lobe scatters from, tilted
    double azimuth, refracted_offset;           // of the viewer; of the ray inside, as an angle
  };

  Inclined incline(Vec3 w) const;
  Viewed view(Vec3 wo) const;
  void attenuate(const Inclined& wo, Viewed& viewed) const;
  double longitudinal(std::size_t lobe, const Viewed& viewed, const Inclined& wi) const;
  double azimuthal(std::size_t lobe, const Viewed& viewed, double wi_azimuth) const;
  // The azimuth by which a lobe turns light.
  double turn(std::size_t lobe, const Viewed& viewed) const;
  BsdfValue evaluate(const Viewed& viewed, Vec3 wi) const;

  Vec3 axis_{1, 0, 0}, side_{0, -1, 0}, normal_{0, 0, 1};  // right-handed
  double offset_, offset_angle_;                           // h and its arc sine
  double eta_;
  Rgb absorption_;
  std::array<double, kLobes> inverse_variances_, norms_;  // of M
  double logistic_scale_, logistic_norm_, logistic_start_;
  std::array<double, 3> tilt_sines_, tilt_cosines_;  // of the scales' tilt times 1, 2 and 4
};

}  // namespace tessera::core
