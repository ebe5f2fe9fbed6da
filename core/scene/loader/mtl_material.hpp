// SPDX-License-Identifier: Apache-2.0
// Turns the materials of MTL files into those that are rendered, as the programs that write them show them.
// docs/scene-format.md has the table. Stateless; thread-safe.
#pragma once

#include "core/materials/material.hpp"
#include "core/scene/loader/mtl_reader.hpp"

namespace tessera::core {

// The diffuse colour of a material that gives none: a mid grey.
inline constexpr Rgb kDefaultDiffuse = Rgb::gray(0.5f);

// Which of the scene's textures a material's maps have become; -1 for those that it lacks.
struct MtlTextures {
  int diffuse = -1, specular = -1, emission = -1, opacity = -1, roughness = -1, normal = -1, bump = -1;
  std::optional<float> metallic;  // the mean of its map
};

// The height of a bump map is its multiplier, which has no unit.
Material make_material(const MtlMaterial& material, const MtlTextures& textures);

}  // namespace tessera::core
