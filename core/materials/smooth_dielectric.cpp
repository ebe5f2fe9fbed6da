// SPDX-License-Identifier: Apache-2.0
#include "core/materials/smooth_dielectric.hpp"

namespace tessera::core {

namespace {

constexpr Vec3 kNormal{0, 0, 1};

}  // namespace

// Radiance increases by eta^2 on entering the denser side (Veach 1997, section 5.2). Paths from the camera
// run against the light, hence the division.
std::optional<BsdfSample> SmoothDielectricBsdf::refracted(Vec3 wo_local) const {
  const auto wi_local = refract(wo_local, kNormal, eta);
  if (!wi_local) return std::nullopt;
  BsdfSample sample = delta_sample(*wi_local, transmittance / (eta * eta));
  sample.transmitted = true;
  sample.eta = eta;
  return sample;
}

// Chooses one of the two directions with the probability of its fraction of the light, which cancels out of
// the weight.
std::optional<BsdfSample> SmoothDielectricBsdf::sample(Vec3 wo_local, Vec2, float u_lobe) const {
  if (u_lobe < dielectric_reflectance(fresnel, wo_local.z, eta))
    return delta_sample(reflect(wo_local, kNormal), reflectance);
  return refracted(wo_local);
}

std::array<std::optional<BsdfSample>, 2> SmoothDielectricBsdf::branches(Vec3 wo_local) const {
  const float reflected = dielectric_reflectance(fresnel, wo_local.z, eta);
  std::array<std::optional<BsdfSample>, 2> both{
      delta_sample(reflect(wo_local, kNormal), reflectance * reflected), refracted(wo_local)};
  if (reflected == 0) both[0].reset();
  if (both[1]) both[1]->weight *= 1 - reflected;
  return both;
}

}  // namespace tessera::core
