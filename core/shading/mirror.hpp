// SPDX-License-Identifier: Apache-2.0
// Ideal mirror reflection. T is float for one point, or FloatN for one in each lane.
#pragma once

#include "core/materials/bsdf_sample.hpp"

namespace tessera::core::shading {

template <typename T>
struct MirrorBsdfOf {
  MaskOf<T> is_delta() const { return true; }
  MaskOf<T> transmits() const { return false; }
  void scale_diffuse(T) {}
  BsdfValueOf<T> evaluate(Vec3Of<T>, Vec3Of<T>, T) const { return {}; }
  BsdfSampleOf<T> sample(Vec3Of<T> wo_local, Vec2Of<T>, T) const {
    BsdfSampleOf<T> sample;
    sample.found = sample.delta = true;
    sample.wi_local = {-wo_local.x, -wo_local.y, wo_local.z};
    sample.weight = reflectance;
    return sample;
  }

  RgbOf<T> reflectance;
};
using MirrorBsdf = MirrorBsdfOf<float>;

}  // namespace tessera::core::shading
