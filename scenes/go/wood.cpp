// SPDX-License-Identifier: Apache-2.0
#include "scenes/go/wood.hpp"

#include <algorithm>
#include <cmath>

#include "core/math/elementary.hpp"
#include "scenes/modelling/files.hpp"
#include "scenes/modelling/noise.hpp"
#include "scenes/modelling/painting.hpp"

namespace tessera::go {
namespace {

using core::Rgb;
using core::Vec3;
using modelling::blend;
using modelling::fractal_noise;
using modelling::noise;
using modelling::smooth_step;
using modelling::srgb;

// In a year wood grows light first and dark last, and ends sharply: 0 light, 1 dark. `ring` counts years.
float late_wood(float ring) {
  const float year = ring - std::floor(ring);
  return smooth_step(0.25f, 0.88f, year) * (1 - smooth_step(0.9f, 1, year));
}

// The trunk stood far to the left of the board, so that its rings are nearly planes; they wander a little
// along the trunk, and good years come and go.
float kaya_ring(Vec3 p) {
  const float wander = 0.9f * noise({p.x * 0.03f, p.y * 0.05f, p.z * 0.013f}) +
                       0.03f * noise({p.x * 0.5f, p.y * 0.5f, p.z * 0.1f});
  const float depth = p.x + 0.22f * p.y + wander;
  return 4.6f * (depth + 1.1f * noise({depth * 0.22f, 7, 3}) + 0.12f * noise({depth * 1.7f, 2, 8}));
}

}  // namespace

Kaya kaya(Vec3 p) {
  const Rgb early = srgb(0xdcae6b), late = srgb(0xb07c3e), deep = srgb(0x9a6631);
  const float ring = kaya_ring(p), year = std::floor(ring), dark = late_wood(ring);
  const float strength = 0.3f + 0.5f * modelling::random_at(static_cast<int>(year), 1, 5) +
                         0.2f * noise({year * 0.21f, 1, p.z * 0.03f});
  const Rgb grain = blend(early, late, std::clamp(strength * dark, 0.0f, 1.0f));
  const float tint = 0.4f + 0.6f * fractal_noise({p.x * 0.09f, p.y * 0.09f, p.z * 0.015f}, 2);
  const Rgb aged = blend(grain, deep, 0.3f * std::clamp(tint, 0.0f, 1.0f));
  const float fiber = fractal_noise({p.x * 11, p.y * 11, p.z * 0.35f}, 3);
  return {aged * (1 + 0.07f * fiber), 0.0011f * dark + 0.0016f * fiber};
}

Rgb mulberry(Vec3 p) {
  const Rgb light = srgb(0x94582a), dark = srgb(0x4c2711), pore = srgb(0x2a150a);
  const Vec3 q{p.x * 0.12f, p.y, p.z};
  const float off_axis = std::sqrt((p.y - 16) * (p.y - 16) + (p.z - 5) * (p.z - 5));
  const float ring = 1.9f * off_axis + 1.2f * fractal_noise(q * 0.25f, 3);
  const float streak = 0.5f + 0.5f * fractal_noise({p.x * 0.15f, p.y * 2.5f, p.z * 2.5f}, 4);
  const float pores = smooth_step(0.35f, 0.75f, noise({p.x * 1.3f, p.y * 9, p.z * 9}));
  const float tone = std::clamp(0.6f * late_wood(ring) + 0.4f * streak, 0.0f, 1.0f);
  return blend(blend(light, dark, tone), pore, 0.5f * pores);
}

Rgb walnut(Vec3 p) {
  constexpr float kPlankWidth = 17;
  const Rgb light = srgb(0x55392a), dark = srgb(0x2a1a13), pore = srgb(0x140c08);
  const float plank = std::floor(p.z / kPlankWidth), across = p.z / kPlankWidth - plank;
  const Vec3 q{p.x * 0.03f, p.z * 0.22f, plank * 11.3f};
  const float ring = 5 * fractal_noise(q, 3) + 0.35f * p.z;
  const float fiber = fractal_noise({p.x * 0.25f, p.z * 10, plank}, 3);
  const float pores = smooth_step(0.3f, 0.7f, noise({p.x * 0.7f, p.z * 8, plank + 40}));
  const float gap = 1 - smooth_step(0, 0.006f, std::min(across, 1 - across));
  const float tone = 0.85f + 0.3f * modelling::random_at(static_cast<int>(plank), 3, 11) + 0.12f * fiber;
  const Rgb wood = blend(light, dark, 0.3f + 0.6f * (0.5f + 0.5f * core::sin(2 * core::kPi * ring)));
  return blend(blend(wood, pore, 0.6f * pores), Rgb{}, 0.8f * gap) * tone;
}

}  // namespace tessera::go
