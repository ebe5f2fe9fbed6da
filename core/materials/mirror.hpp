// SPDX-License-Identifier: Apache-2.0
// Ideal mirror reflection.
#pragma once

#include <optional>

#include "core/materials/bsdf_sample.hpp"

namespace tessera::core {

struct MirrorBsdf {
  static constexpr bool kIsDelta = true;

  void scale_diffuse(float) {}
  BsdfValue evaluate(Vec3, Vec3, float) const { return {}; }

  std::optional<BsdfSample> sample(Vec3 wo_local, Vec2, float) const {
    return delta_sample({-wo_local.x, -wo_local.y, wo_local.z}, reflectance);
  }

  Rgb reflectance;
};

}  // namespace tessera::core
