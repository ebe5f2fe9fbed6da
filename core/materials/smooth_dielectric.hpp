// SPDX-License-Identifier: Apache-2.0
// A smooth dielectric boundary: one reflected and one refracted direction.
#pragma once

#include <array>
#include <optional>

#include "core/materials/bsdf_sample.hpp"
#include "core/materials/fresnel.hpp"

namespace tessera::core {

struct SmoothDielectricBsdf {
  static constexpr bool kIsDelta = true;

  void scale_diffuse(float) {}
  BsdfValue evaluate(Vec3, Vec3, float) const { return {}; }
  std::optional<BsdfSample> sample(Vec3 wo_local, Vec2 u, float u_lobe) const;
  // Both directions, each weighted by its fraction of the light; nothing for a direction that does not
  // exist.
  std::array<std::optional<BsdfSample>, 2> branches(Vec3 wo_local) const;

  float eta;  // of the far side over the near side
  DielectricFresnel fresnel;
  Rgb reflectance, transmittance;

 private:
  std::optional<BsdfSample> refracted(Vec3 wo_local) const;
};

}  // namespace tessera::core
