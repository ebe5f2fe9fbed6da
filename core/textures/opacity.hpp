// SPDX-License-Identifier: Apache-2.0
// The opacity of a surface at a point: the probability that light hits it.
#pragma once

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

}  // namespace tessera::core
