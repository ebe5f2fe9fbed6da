// SPDX-License-Identifier: Apache-2.0
// Parts of validate_scene() (validation.hpp), with its errors: colours, materials and media. Stateless;
// thread-safe.
#pragma once

#include <vector>

#include "core/base/error.hpp"
#include "core/scene/description.hpp"

namespace tessera::core {

// Whether the colour is finite and not negative.
bool is_valid_radiance(Rgb color);
// Also checks the product with the texture's largest value. The texture must exist.
bool is_valid_radiance(const ColorParameter& color, const std::vector<Texture>& textures);

// Checks materials, whose textures and media are those of the scene.
Status check_materials(const std::vector<Material>& materials, const SceneDescription& scene);
// Checks a medium, whose grids are those of the scene; and all media and grids, and the camera's medium.
Status check_medium(const MediumDescription& medium, const SceneDescription& scene);
Status check_media(const SceneDescription& scene);

}  // namespace tessera::core
