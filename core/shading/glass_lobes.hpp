// SPDX-License-Identifier: Apache-2.0
// Lobes (lobe.hpp) of clear dielectrics: a boundary, and a thin sheet.
#pragma once

#include <cmath>

#include "core/materials/anisotropic_ggx.hpp"
#include "core/materials/directional_albedo.hpp"
#include "core/materials/limits.hpp"
#include "core/shading/lobe.hpp"
#include "core/shading/rough_dielectric.hpp"
#include "core/shading/smooth_dielectric.hpp"

namespace tessera::core::shading {

// A dielectric boundary that reflects and transmits, without loss: what single scattering loses is given back
// to both.
template <typename T>
class GlassLobe {
 public:
  static constexpr bool kIsDiffuse = false;

  GlassLobe() = default;
  // Smooth if alpha is below kMinAlpha, or the boundary's eta close to 1.
  GlassLobe(const DielectricBoundaryOf<T>& boundary, T alpha)
      : smooth_{boundary, {}}, rough_{GgxOf<T>(larger(alpha, T(kMinAlpha))), boundary, {}} {
    using std::fabs;
    is_smooth_ = (alpha < kMinAlpha) | (fabs(boundary.eta - 1) < kMinBending);
  }

  MaskOf<T> is_delta() const { return is_smooth_; }
  MaskOf<T> transmits() const { return !is_smooth_; }
  T eta() const { return rough_.boundary.eta; }
  BsdfValueOf<T> evaluate(Vec3Of<T> wo, Vec3Of<T> wi, T diffuse_cos) const {
    if (all(is_smooth_)) return {};
    const BsdfValueOf<T> single = rough_.evaluate(wo, wi, diffuse_cos);
    const T scattered = DirectionalAlbedo::tables().template scattered<T>(wo.z, rough_.facets.alpha(), eta());
    return only_where<T>(!is_smooth_, {single.value / scattered, single.pdf});
  }
  BsdfSampleOf<T> sample(Vec3Of<T> wo, Vec2Of<T> u, T u_lobe) const {
    BsdfSampleOf<T> sample;
    if (!all(is_smooth_)) sample = rough_.sample(wo, u, u_lobe);
    return any(is_smooth_) ? select(is_smooth_, smooth_.sample(wo, u, u_lobe), sample) : sample;
  }
  std::array<std::optional<BsdfSample>, 2> delta_branches(Vec3Of<T> wo) const {
    if (!is_smooth_) return {};
    return smooth_.branches(wo);
  }
  T albedo(T) const { return T(1.0f); }

 private:
  SmoothDielectricOf<T> smooth_;
  RoughDielectricOf<T> rough_;
  MaskOf<T> is_smooth_{};
};

// A sheet of a dielectric, with all reflections between its sides: light leaves it unrefracted (Born and Wolf
// 1999, section 7.6, without interference).
template <typename T>
struct ThinGlassLobe {
  static constexpr bool kIsDiffuse = false;
  MaskOf<T> is_delta() const { return smooth; }
  MaskOf<T> transmits() const { return !smooth; }

  // Reflection and transmission together are a surface that reflects everything, with what is transmitted
  // mirrored to the other side.
  BsdfValueOf<T> evaluate(Vec3Of<T> wo, Vec3Of<T> wi, T) const {
    using std::fabs;
    const MaskOf<T> lit = !(smooth | (wi.z == 0));
    if (!any(lit)) return {};
    const Vec3Of<T> above{wi.x, wi.y, fabs(wi.z)};
    const Vec3Of<T> h = normalize(wo + above);
    const T cos_oh = dot(wo, h), back = reflected(cos_oh);
    const T facets = ggx.density(h) * ggx.smith_visibility(wo, above) * above.z /
                     DirectionalAlbedo::tables().template reflecting<T>(wo.z, ggx.mean_alpha());
    const T pdf = ggx.pdf_visible(wo, h) / (4 * cos_oh);
    const MaskOf<T> reflects = wi.z > 0;
    return only_where<T>(
        lit, {select(reflects, reflectance * (back * facets), transmittance * ((1 - back) * facets)),
              select(reflects, back * pdf, (1 - back) * pdf)});
  }
  BsdfSampleOf<T> sample(Vec3Of<T> wo, Vec2Of<T> u, T u_lobe) const {
    BsdfSampleOf<T> sample;
    if (!all(smooth)) {
      const Vec3Of<T> h = ggx.sample_visible(wo, u);
      const T cos_oh = dot(wo, h);
      const Vec3Of<T> wi = normalize(reflect(wo, h));
      const MaskOf<T> found = !((cos_oh <= 0) | (wi.z <= 0));
      sample = unweighed_sample<T>(found, {wi.x, wi.y, select(u_lobe < reflected(cos_oh), wi.z, -wi.z)});
    }
    if (!any(smooth)) return sample;
    const MaskOf<T> reflects = u_lobe < reflected(wo.z);
    return select(smooth, select(reflects, reflection(wo), transmission(wo)), sample);
  }
  std::array<std::optional<BsdfSample>, 2> delta_branches(Vec3Of<T> wo) const {
    if (!smooth) return {};
    const T back = reflected(wo.z);
    std::array<std::optional<BsdfSample>, 2> both{alone(reflection(wo)), alone(transmission(wo))};
    both[0]->weight *= back;
    both[1]->weight *= 1 - back;
    return both;
  }
  T albedo(T) const { return T(1.0f); }

  T eta = T(1.0f);
  AnisotropicGgxOf<T> ggx;
  MaskOf<T> smooth{};
  RgbOf<T> reflectance, transmittance;  // tints

 private:
  BsdfSampleOf<T> reflection(Vec3Of<T> wo) const {
    return delta_sample_of<T>({-wo.x, -wo.y, wo.z}, reflectance, false);
  }
  BsdfSampleOf<T> transmission(Vec3Of<T> wo) const { return delta_sample_of<T>(-wo, transmittance, true); }
  T reflected(T cos_i) const {
    const T one_side = fresnel_dielectric<T>(cos_i, eta);
    return 2 * one_side / (1 + one_side);
  }
};

}  // namespace tessera::core::shading
