// SPDX-License-Identifier: Apache-2.0
// Mirrors and dielectric boundaries, smooth or rough, in each lane. T is float for one point, or Float8 for
// one in each lane.
#pragma once

#include "core/shading/lobe.hpp"
#include "core/shading/mirror.hpp"
#include "core/shading/rough_dielectric.hpp"
#include "core/shading/smooth_dielectric.hpp"

namespace tessera::core {

template <typename T>
struct SpecularBsdfOf {
  MaskOf<T> is_delta() const { return !is_rough; }
  MaskOf<T> transmits() const { return is_rough; }
  void scale_diffuse(T) {}
  BsdfValueOf<T> evaluate(Vec3Of<T> wo_local, Vec3Of<T> wi_local, T diffuse_cos) const {
    if (!any(is_rough)) return {};
    return only_where<T>(is_rough, rough.evaluate(wo_local, wi_local, diffuse_cos));
  }
  BsdfSampleOf<T> sample(Vec3Of<T> wo_local, Vec2Of<T> u, T u_lobe) const {
    BsdfSampleOf<T> sample;
    if (!all(is_mirror)) sample = smooth.sample(wo_local, u, u_lobe);
    if (any(is_rough)) sample = select(is_rough, rough.sample(wo_local, u, u_lobe), sample);
    if (any(is_mirror)) sample = select(is_mirror, mirror.sample(wo_local, u, u_lobe), sample);
    return sample;
  }

  MaskOf<T> is_mirror{}, is_rough{};  // elsewhere it is smooth glass
  MirrorBsdfOf<T> mirror;
  SmoothDielectricOf<T> smooth;
  RoughDielectricOf<T> rough;
};

}  // namespace tessera::core
