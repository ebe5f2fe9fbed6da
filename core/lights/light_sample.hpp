// SPDX-License-Identifier: Apache-2.0
// The result of sampling a light, common to all types.
#pragma once

#include <optional>

#include "core/geometry/surface.hpp"
#include "core/math/rgb.hpp"
#include "core/math/simd_double.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core::lights {

// Light that arrives at the reference point from `wi`, visibility not included. Its contribution is bsdf *
// cos * radiance / pdf for every type of light.
struct LightSample {
  Vec3 wi;             // unit, from the reference point towards the light
  Rgb radiance;        // for a delta light, the irradiance of a surface that faces it
  float pdf = 0;       // per solid angle; 1 for a delta light: the deltas of radiance and density cancel
  bool delta = false;  // a delta direction, which no scattered ray finds
  std::optional<SurfacePoint> point;  // the point on the light, without shading normal; none at infinity
};

// Samples in lanes, one for each reference point.
struct LightSamples {
  MaskN found = false;  // lanes with a sample
  Vec3Of<FloatN> wi;    // zero in other lanes
  RgbOf<FloatN> radiance;
  FloatN pdf{};
  MaskN delta = false;
  MaskN distant = false;  // has no point
  SurfacePointOf<FloatN> point;
};

}  // namespace tessera::core::lights
