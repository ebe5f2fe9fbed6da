// SPDX-License-Identifier: Apache-2.0
// Mirrors and dielectric boundaries, smooth or rough. T is float for one point, or FloatN for one in each
// lane; Facets are those of RoughDielectricOf.
#pragma once

#include "core/shading/mirror.hpp"
#include "core/shading/rough_dielectric.hpp"
#include "core/shading/smooth_dielectric.hpp"

namespace tessera::core::shading {

template <typename T, typename Facets = GgxOf<T>>
struct SpecularBsdfOf {
  MaskOf<T> is_delta() const { return !is_rough; }
  MaskOf<T> transmits() const { return is_rough; }
  T transmitted_eta() const { return rough.boundary.eta; }
  void scale_diffuse(T) {}
  BsdfValueOf<T> evaluate(Vec3Of<T> wo_local, Vec3Of<T> wi_local, T diffuse_cos) const {
    if (!any(is_rough)) return {};
    return only_where<T>(is_rough, rough.evaluate(wo_local, wi_local, diffuse_cos));
  }
  BsdfSampleOf<T> sample(Vec3Of<T> wo_local, Vec2Of<T> u, T u_lobe) const {
    BsdfSampleOf<T> sample;
    if (!all(is_mirror | is_rough)) sample = smooth.sample(wo_local, u, u_lobe);
    if (any(is_rough)) sample = select(is_rough, rough.sample(wo_local, u, u_lobe), sample);
    if (any(is_mirror)) sample = select(is_mirror, mirror.sample(wo_local, u, u_lobe), sample);
    return sample;
  }
  // For T = float.
  DeltaBranches delta_branches(Vec3 wo_local) const {
    if (is_rough) return {};
    if (is_mirror) return {alone(mirror.sample(wo_local, {}, 0)), {}, {}};
    const auto [reflected, refracted] = smooth.branches(wo_local);
    return {reflected, refracted, {}};
  }

  MaskOf<T> is_mirror{}, is_rough{};  // elsewhere it is smooth glass
  MirrorBsdfOf<T> mirror;
  SmoothDielectricOf<T> smooth;
  RoughDielectricOf<T, Facets> rough;
};

}  // namespace tessera::core::shading
