// SPDX-License-Identifier: Apache-2.0
// The results of BSDFs: value and density for a pair of directions, and sampled directions.
#pragma once

#include "core/math/rgb.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core {

template <typename T>
struct BsdfValueOf {
  RgbOf<T> value;  // bsdf * |cos(wi)|
  T pdf{};         // of sampling wi, per solid angle
};
using BsdfValue = BsdfValueOf<float>;

struct BsdfSample {
  Vec3 wi_local;
  Rgb weight;     // bsdf * |cos(wi)| / pdf
  float pdf = 0;  // unspecified if `delta`
  bool delta = false;
  bool transmitted = false;
  float eta = 1;  // for transmission: index of refraction on the far side over the near side
};

inline BsdfSample delta_sample(Vec3 wi_local, Rgb weight) {
  BsdfSample sample;
  sample.wi_local = wi_local;
  sample.weight = weight;
  sample.delta = true;
  return sample;
}

// Computes a sample's weight from its value, whose pdf must be positive.
inline BsdfSample weighed_sample(Vec3 wi_local, const BsdfValue& value) {
  BsdfSample sample;
  sample.wi_local = wi_local;
  sample.weight = value.value / value.pdf;
  sample.pdf = value.pdf;
  return sample;
}

}  // namespace tessera::core
