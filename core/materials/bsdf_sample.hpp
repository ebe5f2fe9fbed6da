// SPDX-License-Identifier: Apache-2.0
// What every BSDF answers: its value and density for a pair of directions, and sampled directions.
#pragma once

#include "core/math/rgb.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core {

template <typename T>
struct BsdfValueOf {
  RgbOf<T> value;  // bsdf * |cos(wi)|
  T pdf{};         // with which sampling chooses wi, per solid angle
};
using BsdfValue = BsdfValueOf<float>;

struct BsdfSample {
  Vec3 wi_local;
  Rgb weight;     // bsdf * |cos(wi)| / pdf
  float pdf = 0;  // meaningless where `delta`
  bool delta = false;
  bool transmitted = false;
  float eta = 1;  // transmitted: index of refraction on the far side over that on the near side
};

inline BsdfSample delta_sample(Vec3 wi_local, Rgb weight) {
  BsdfSample sample;
  sample.wi_local = wi_local;
  sample.weight = weight;
  sample.delta = true;
  return sample;
}

// A sample whose weight follows from its value; the value's pdf is above 0.
inline BsdfSample weighed_sample(Vec3 wi_local, const BsdfValue& value) {
  BsdfSample sample;
  sample.wi_local = wi_local;
  sample.weight = value.value / value.pdf;
  sample.pdf = value.pdf;
  return sample;
}

}  // namespace tessera::core
