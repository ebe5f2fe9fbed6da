// Ideal diffuse reflection (Lambert 1760), sampled in proportion to the cosine.
#pragma once

#include <optional>

#include "core/materials/bsdf_sample.hpp"
#include "core/sampling/warp.hpp"

namespace tessera::core {

struct LambertBsdf {
  static constexpr bool kIsDelta = false;

  BsdfValue evaluate(Vec3 wo_local, Vec3 wi_local) const {
    if (wo_local.z <= 0 || wi_local.z <= 0) return {};
    return {albedo * (wi_local.z / kPi), pdf_cosine_hemisphere(wi_local.z)};
  }

  std::optional<BsdfSample> sample(Vec3 wo_local, Vec2 u, float) const {
    if (wo_local.z <= 0) return std::nullopt;
    BsdfSample sample;
    sample.wi_local = sample_cosine_hemisphere(u);
    sample.weight = albedo;
    sample.pdf = pdf_cosine_hemisphere(sample.wi_local.z);
    return sample;
  }

  Rgb albedo;
};

}  // namespace tessera::core
