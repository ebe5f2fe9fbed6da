// SPDX-License-Identifier: Apache-2.0
// Materials as scene files write them. Not thread-safe.
#pragma once

#include <string>
#include <vector>

#include "core/materials/material.hpp"
#include "core/scene/writer/json_text.hpp"

namespace tessera::core {

// The names by which materials refer to other parts of the scene; each is unique among its kind.
struct SceneNames {
  std::vector<std::string> textures, media, materials, objects;
};

// A number or a colour, with its texture if it has one. `factor` is the key of what multiplies the texture.
std::string parameter_text(const ColorParameter& parameter, const SceneNames& names);
std::string parameter_text(const ScalarParameter& parameter, const SceneNames& names);

// Parameters that have their default are left out.
std::string material_text(const Material& material, const SceneNames& names);

}  // namespace tessera::core
