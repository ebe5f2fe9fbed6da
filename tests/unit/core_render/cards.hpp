// SPDX-License-Identifier: Apache-2.0
// Cards that let light pass, before a camera.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "tests/support/test_scenes.hpp"

namespace tessera::core::integrators::opacity_test {

inline constexpr CameraDescription kTowardsOrigin{
    .position = {0, 0, 4}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 2};

// Faces +z at this height, and is 2 * half wide.
inline QuadDescription card(float z, std::uint32_t material, float half = 1) {
  return {{-half, -half, z}, {2 * half, 0, 0}, {0, 2 * half, 0}, material};
}

inline std::uint32_t translucent(test::SceneMaker& maker, MaterialModel model, float opacity,
                                 Rgb emission = {}) {
  const std::uint32_t material = maker.material(std::move(model), emission);
  maker.description().materials[material].opacity = opacity;
  return material;
}

inline Texture texture_of(int width, int height, const std::vector<float>& values) {
  std::vector<float> rgb;
  for (const float value : values) rgb.insert(rgb.end(), {value, 0.25f, 0.75f});
  return {.image = std::make_shared<TextureImage>(width, height, rgb), .wrap = Wrap::kClamp};
}

}  // namespace tessera::core::integrators::opacity_test
