// SPDX-License-Identifier: Apache-2.0
// The results of BSDFs: value and density for a pair of directions, and sampled directions.
#pragma once

#include <array>
#include <optional>

#include "core/math/rgb.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core {

template <typename T>
struct BsdfValueOf {
  RgbOf<T> value;  // bsdf * |cos(wi)|
  T pdf{};         // of sampling wi, per solid angle
};
using BsdfValue = BsdfValueOf<float>;

// `value` where the mask is set, else nothing.
template <typename T>
BsdfValueOf<T> only_where(MaskOf<T> mask, const BsdfValueOf<T>& value) {
  return {select(mask, value.value, RgbOf<T>{}), select(mask, value.pdf, T(0.0f))};
}

struct BsdfSample {
  Vec3 wi_local;
  Rgb weight;     // bsdf * |cos(wi)| / pdf
  float pdf = 0;  // unspecified if `delta`
  bool delta = false;
  bool transmitted = false;
  float eta = 1;  // for transmission: index of refraction on the far side over the near side
};

// All directions of delta lobes, each weighted by its fraction of the light: reflection, transmission, and
// reflection by a coat in a frame of its own.
using DeltaBranches = std::array<std::optional<BsdfSample>, 3>;

// A sample in each lane. T is float for one, or FloatN for one in each lane.
template <typename T>
struct BsdfSampleOf {
  MaskOf<T> found{}, delta{}, transmitted{};
  Vec3Of<T> wi_local;
  RgbOf<T> weight;  // the rest as in BsdfSample
  T pdf{}, eta = T(1.0f);
};

// `a` where the mask is set, else `b`.
template <typename T>
BsdfSampleOf<T> select(MaskOf<T> mask, const BsdfSampleOf<T>& a, const BsdfSampleOf<T>& b) {
  return {select_mask(mask, a.found, b.found),
          select_mask(mask, a.delta, b.delta),
          select_mask(mask, a.transmitted, b.transmitted),
          select(mask, a.wi_local, b.wi_local),
          select(mask, a.weight, b.weight),
          select(mask, a.pdf, b.pdf),
          select(mask, a.eta, b.eta)};
}

// A sample of one point.
inline std::optional<BsdfSample> alone(const BsdfSampleOf<float>& sample) {
  if (!sample.found) return std::nullopt;
  return BsdfSample{sample.wi_local, sample.weight, sample.pdf, sample.delta, sample.transmitted, sample.eta};
}

// A sample with this value, in lanes where its density is positive. eta is that of transmission.
template <typename T>
BsdfSampleOf<T> weighed_sample(MaskOf<T> found, Vec3Of<T> wi_local, const BsdfValueOf<T>& value, T eta) {
  const MaskOf<T> transmitted = wi_local.z < 0, likely = found & (value.pdf > 0);
  return {likely,
          false,
          transmitted,
          wi_local,
          value.value / value.pdf,
          value.pdf,
          select(transmitted, eta, T(1.0f))};
}

}  // namespace tessera::core
