// SPDX-License-Identifier: Apache-2.0
// Images of skies for tests.
#pragma once

#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "core/textures/texture.hpp"

namespace tessera::test {

using SkyImage = std::shared_ptr<const core::TextureImage>;

// Gray; value(x, y) from the top left.
inline SkyImage sky_image(int width, int height, const std::function<float(int, int)>& value) {
  std::vector<float> texels;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) texels.insert(texels.end(), 3, value(x, y));
  return std::make_shared<core::TextureImage>(core::TextureImage{width, height, std::move(texels)});
}

}  // namespace tessera::test
