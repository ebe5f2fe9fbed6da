// SPDX-License-Identifier: Apache-2.0
// The parameters of materials that may have a texture. They are evaluated at a point by
// core/textures/texture.hpp.
#pragma once

#include <vector>

#include "core/math/rgb.hpp"
#include "core/textures/texture_point.hpp"

namespace tessera::core {

struct Texture;

// A constant, or a texture times a constant.
struct ColorParameter {
  Rgb value = Rgb::gray(1);
  int texture = -1;  // index among the scene's textures, -1 for none

  bool operator==(const ColorParameter&) const = default;

  Rgb evaluate(const std::vector<Texture>& textures, const TexturePoint& at) const;
};

// A number, or the red channel of a texture times a number.
struct ScalarParameter {
  ScalarParameter(float constant = 0, int texture_index = -1) : value(constant), texture(texture_index) {}

  float value;
  int texture;  // as above

  bool operator==(const ScalarParameter&) const = default;

  float evaluate(const std::vector<Texture>& textures, const TexturePoint& at) const;
};

}  // namespace tessera::core
