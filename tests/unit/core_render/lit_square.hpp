// SPDX-License-Identifier: Apache-2.0
// A diffuse square under lights, whose radiance has a closed form.
#pragma once

#include <numbers>

#include "tests/support/test_scenes.hpp"

namespace tessera::test {

inline constexpr float kSquareAlbedo = 0.6f;

// A camera that sees almost only the origin, from above and aside, and a diffuse square there that faces up.
inline SceneMaker lit_square() {
  SceneMaker maker(
      {.position = {2, 3, 1}, .look_at = {0, 0, 0}, .up = {0, 1, 0.1f}, .vertical_fov_degrees = 0.01f});
  maker.add(core::QuadDescription{{-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, maker.material(lambert(kSquareAlbedo))});
  return maker;
}

// The radiance of the square under an irradiance.
inline double reflected(double irradiance) {
  return static_cast<double>(kSquareAlbedo) / std::numbers::pi * irradiance;
}

}  // namespace tessera::test
