// SPDX-License-Identifier: Apache-2.0
// A smooth dielectric boundary: one reflected and one refracted direction. T is float for one point, or
// FloatN for one in each lane.
#pragma once

#include <array>
#include <optional>

#include "core/materials/bsdf_sample.hpp"
#include "core/materials/fresnel.hpp"
#include "core/shading/dielectric_boundary.hpp"

namespace tessera::core::shading {

template <typename T>
struct SmoothDielectricOf {
  MaskOf<T> is_delta() const { return true; }
  MaskOf<T> transmits() const { return false; }
  void scale_diffuse(T) {}
  BsdfValueOf<T> evaluate(Vec3Of<T>, Vec3Of<T>, T) const { return {}; }

  // Chooses one of the two directions with the probability of its fraction of the light, which cancels out of
  // the weight.
  BsdfSampleOf<T> sample(Vec3Of<T> wo_local, Vec2Of<T>, T u_lobe) const {
    const MaskOf<T> reflects = u_lobe < fresnel(wo_local.z, boundary.fresnel_eta);
    const BsdfSampleOf<T> through = refraction(wo_local);
    return select(reflects, reflection(wo_local), through);
  }
  // Both directions, each weighted by its fraction of the light; nothing for a direction that does not
  // exist.
  std::array<std::optional<BsdfSample>, 2> branches(Vec3Of<T> wo_local) const {
    const T reflected = fresnel(wo_local.z, boundary.fresnel_eta);
    std::array<std::optional<BsdfSample>, 2> both{alone(reflection(wo_local)), alone(refraction(wo_local))};
    both[0]->weight *= reflected;
    if (reflected == 0) both[0].reset();
    if (both[1]) both[1]->weight *= 1 - reflected;
    return both;
  }

  DielectricBoundaryOf<T> boundary;
  DielectricFresnelOf<T> fresnel;

 private:
  static Vec3Of<T> normal() { return {T(0.0f), T(0.0f), T(1.0f)}; }
  BsdfSampleOf<T> reflection(Vec3Of<T> wo_local) const {
    BsdfSampleOf<T> sample;
    sample.found = sample.delta = true;
    sample.wi_local = reflect(wo_local, normal());
    sample.weight = boundary.reflectance;
    return sample;
  }
  // Radiance increases by eta^2 on entering the denser side (Veach 1997, section 5.2). Paths from the camera
  // run against the light, hence the division.
  BsdfSampleOf<T> refraction(Vec3Of<T> wo_local) const {
    const auto [found, wi_local] = refracted(wo_local, normal(), boundary.eta);
    BsdfSampleOf<T> sample;
    sample.found = found;
    sample.delta = sample.transmitted = true;
    sample.wi_local = wi_local;
    sample.weight = boundary.transmittance / (boundary.eta * boundary.eta);
    sample.eta = boundary.eta;
    return sample;
  }
};
using SmoothDielectricBsdf = SmoothDielectricOf<float>;

}  // namespace tessera::core::shading
