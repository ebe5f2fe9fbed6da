// SPDX-License-Identifier: Apache-2.0
// Ideal diffuse reflection (Lambert 1760), sampled in proportion to the cosine.
#pragma once

#include "core/materials/bsdf_sample.hpp"
#include "core/sampling/warp.hpp"

namespace tessera::core::shading {

// T is float for one point, or FloatN for one in each lane.
template <typename T>
struct LambertBsdfOf {
  MaskOf<T> is_delta() const { return false; }
  MaskOf<T> transmits() const { return false; }
  void scale_diffuse(T factor) { albedo *= factor; }

  BsdfValueOf<T> evaluate(Vec3Of<T> wo_local, Vec3Of<T> wi_local, T diffuse_cos) const {
    const MaskOf<T> dark = (wo_local.z <= 0) | (wi_local.z <= 0);
    return {select(dark, RgbOf<T>{}, albedo * (diffuse_cos / kPi)),
            select(dark, T(0.0f), sampling::pdf_cosine_hemisphere(wi_local.z))};
  }

  BsdfSampleOf<T> sample(Vec3Of<T> wo_local, Vec2Of<T> u, T) const {
    BsdfSampleOf<T> sample;
    sample.found = wo_local.z > 0;
    sample.wi_local = sampling::sample_cosine_hemisphere(u);
    sample.weight = albedo;
    sample.pdf = sampling::pdf_cosine_hemisphere(sample.wi_local.z);
    return sample;
  }

  RgbOf<T> albedo;
};
using LambertBsdf = LambertBsdfOf<float>;

}  // namespace tessera::core::shading
