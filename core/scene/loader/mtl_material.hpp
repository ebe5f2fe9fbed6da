// SPDX-License-Identifier: Apache-2.0
// Converts MTL materials to the renderer's, matching the look in the programs that write them.
// docs/scene-format.md has the table. Stateless; thread-safe.
#pragma once

#include "core/materials/material.hpp"
#include "core/scene/loader/mtl_reader.hpp"

namespace tessera::core {

// The default diffuse colour: mid grey.
inline constexpr Rgb kDefaultDiffuse = Rgb::gray(0.5f);

// The scene textures of a material's maps; -1 for missing ones.
struct MtlTextures {
  int diffuse = -1, specular = -1, emission = -1, opacity = -1, normal = -1, bump = -1;
  int roughness = -1, metallic = -1, coat = -1, coat_roughness = -1, sheen = -1;
};

// A material with keys of the physically based extension (Pr, Pm, Pc, Ps, aniso and their maps) becomes a
// Principled one. The height of a bump map is its multiplier, which has no unit yet.
Material make_material(const MtlMaterial& material, const MtlTextures& textures);

}  // namespace tessera::core
