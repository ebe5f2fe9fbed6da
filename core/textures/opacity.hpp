// SPDX-License-Identifier: Apache-2.0
// The opacity of a surface at a point: the probability that light hits it.
#pragma once

#include <variant>
#include <vector>

#include "core/textures/texture.hpp"

namespace tessera::core {

// In [0, 1]. Values that rounding leaves just below 1 between texels of 1 become 1.
inline float opacity_at(const ScalarParameter& opacity, const std::vector<Texture>& textures,
                        const TexturePoint& at) {
  constexpr float kAlmostOne = 1 - 0x1p-20f;
  const float value = opacity.evaluate(textures, at);
  if (value >= kAlmostOne) return 1;
  return value > 0 ? value : 0;
}

// The image that alone determines an opacity, as it is or compared with a threshold; null for other textures.
inline const TextureImage* image_of_opacity(const ScalarParameter& opacity,
                                            const std::vector<Texture>& textures) {
  if (opacity.texture < 0) return nullptr;
  const Texture* texture = &textures[static_cast<std::size_t>(opacity.texture)];
  if (texture->procedural) {
    const auto* step = std::get_if<StepPattern>(&texture->procedural->pattern);
    if (step == nullptr || step->base.texture < 0) return nullptr;
    texture = &textures[static_cast<std::size_t>(step->base.texture)];
  }
  return texture->image.get();
}

}  // namespace tessera::core
