// SPDX-License-Identifier: Apache-2.0
// Parts of validate_scene() (validation.hpp), with its errors: colours, materials and media. Stateless;
// thread-safe.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"
#include "core/scene/description.hpp"

namespace tessera::core {

// Whether the colour is finite and not negative.
bool is_valid_radiance(Rgb color);
// Also checks the product with the texture's largest value. The texture must exist.
bool is_valid_radiance(const ColorParameter& color, const std::vector<Texture>& textures);

// Moves the parameters without texture that are out of range to its limits, for readers of other programs'
// files, and the factors of maps. Returns their keys.
std::vector<std::string_view> clamp_to_ranges(Material& material);
// The warning about one of them.
std::string clamped_text(std::string_view material, std::string_view key);

// Checks materials, whose textures and media are those of the scene.
Status check_materials(const std::vector<Material>& materials, const SceneDescription& scene);
// Calls refuse(i, error) for each material of the scene that check_materials() would refuse, as if what is
// refused had been replaced by a material of one layer. The errors do not name the material. Priorities
// (priorities.hpp) are not checked.
void check_each_material(const SceneDescription& scene,
                         const std::function<void(std::size_t, const Error&)>& refuse);
// Checks a medium, whose grids are those of the scene; and all media and grids, and the camera's medium.
Status check_medium(const MediumDescription& medium, const SceneDescription& scene);
Status check_media(const SceneDescription& scene);

}  // namespace tessera::core
