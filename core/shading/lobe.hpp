// SPDX-License-Identifier: Apache-2.0
// What lobes are: parts of which a closure (closure.hpp) consists. Each scatters white light unless it has a
// colour of its own; the closure multiplies it, and takes off what the layers above keep. T is float for one
// point, or FloatN for one in each lane. Directions as in bsdf.hpp, with +x along dp/du.
//
// A lobe has
//   kIsDiffuse                        whether diffuse_cos is its cosine (Bsdf::evaluate)
//   is_delta(), transmits()           whether it is a delta lobe; whether it also scatters to the other side,
//                                     without being one
//   evaluate(wo, wi, diffuse_cos)     BSDF times cosine, and the density with which sample() generates wi
//   sample(wo, u, u_lobe)             only delta lobes give a weight; the closure weighs all others
//   albedo(cos_o)                     the share of the light from everywhere that it scatters to a viewer,
//   for
//                                     sampling and for the layers below
//   delta_branches(wo)                of T = float: the directions of a delta lobe, weighted by their
//                                     fractions of the light
// and is white, or absent, where it is default-constructed.
#pragma once

#include <array>
#include <optional>

#include "core/materials/bsdf_sample.hpp"
#include "core/math/simd_double.hpp"

namespace tessera::core::shading {

// What lobes have in common unless they say otherwise.
template <typename T>
struct RoughLobe {
  static constexpr bool kIsDiffuse = false;
  MaskOf<T> is_delta() const { return false; }
  MaskOf<T> transmits() const { return false; }
  std::array<std::optional<BsdfSample>, 2> delta_branches(Vec3Of<T>) const { return {}; }
};

// A sample that the closure weighs.
template <typename T>
BsdfSampleOf<T> unweighed_sample(MaskOf<T> found, Vec3Of<T> wi) {
  BsdfSampleOf<T> sample;
  sample.found = found;
  sample.transmitted = wi.z < 0;
  sample.wi_local = wi;
  return sample;
}

template <typename T>
BsdfSampleOf<T> delta_sample_of(Vec3Of<T> wi, RgbOf<T> weight, MaskOf<T> transmitted) {
  BsdfSampleOf<T> sample;
  sample.found = sample.delta = true;
  sample.transmitted = transmitted;
  sample.wi_local = wi;
  sample.weight = weight;
  return sample;
}

template <typename T>
RgbOf<T> plus_gray(RgbOf<T> a, T b) {
  return a + RgbOf<T>::gray(b);
}

template <typename T>
RgbOf<T> quotient(RgbOf<T> a, RgbOf<T> b) {
  return {a.r / b.r, a.g / b.g, a.b / b.b};
}

}  // namespace tessera::core::shading
