// SPDX-License-Identifier: Apache-2.0
#include "scenes/modelling/painting.hpp"

#include <algorithm>

#include "scenes/modelling/lathe.hpp"
#include "scenes/modelling/noise.hpp"

namespace tessera::modelling {

using core::Rgb;
using core::Vec3;

float smooth_step(float begin, float end, float x) {
  const float t = std::clamp((x - begin) / (end - begin), 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}

Rgb blend(Rgb a, Rgb b, float t) {
  return a + (b - a) * t;
}

float specks(Vec3 p, float per_cm) {
  const Cell cell = cellular_noise(p * per_cm);
  const float radius = 0.1f + 0.28f * cell.random * cell.random;
  return 1 - smooth_step(radius * 0.7f, radius, cell.nearest);
}

core::Image paint_on(const Profile& profile, int width, int height,
                     const std::function<Rgb(Vec3 p, float u, float v)>& color) {
  return paint(width, height, [&](float u, float v) { return color(revolve(profile.at(v), u), u, v); });
}

}  // namespace tessera::modelling
