// SPDX-License-Identifier: Apache-2.0
// What sampling a light answers, the same for lights of every kind.
#pragma once

#include <optional>

#include "core/geometry/surface.hpp"
#include "core/math/rgb.hpp"
#include "core/math/simd_double8.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core {

// Light that arrives at the lit point from `wi`, if nothing is in between. Its share of the reflected light
// is bsdf * cos * radiance / pdf, whatever the kind.
struct LightSample {
  Vec3 wi;             // unit, from the lit point towards the light
  Rgb radiance;        // of a delta light the irradiance of a surface that faces it
  float pdf = 0;       // per solid angle; of a delta light 1, since the deltas of radiance and density cancel
  bool delta = false;  // comes from one direction only: no ray that is scattered finds it
  std::optional<SurfacePoint> point;  // where the light begins, without its shading normal; none at infinity
};

// Eight of them, for eight lit points.
struct LightSamples {
  Mask8 found = false;  // where there is one at all
  Vec3Of<Float8> wi;    // zero elsewhere
  RgbOf<Float8> radiance;
  Float8 pdf{};
  Mask8 delta = false;
  Mask8 distant = false;  // has no point
  SurfacePointOf<Float8> point;
};

}  // namespace tessera::core
