// SPDX-License-Identifier: Apache-2.0
// Checks of textures. Stateless; thread-safe.
#pragma once

#include <vector>

#include "core/base/error.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core {

// Each is an image or a procedural texture, whose inputs stand before it and whose numbers can be computed
// with. INVALID_ARGUMENT names the first mistake.
Status check_textures(const std::vector<Texture>& textures);

// Whether the texture is an image; true for -1, no texture, and for those that do not exist.
bool is_image(int texture, const std::vector<Texture>& textures);

}  // namespace tessera::core
