// SPDX-License-Identifier: Apache-2.0
// Blends, resolved at a point: one part scatters, chosen by a random number, so that every part keeps its own
// BSDF, maps and sampling. `all` are the scene's materials.
#pragma once

#include <vector>

#include "core/materials/material.hpp"

namespace tessera::core {

// The probability that light hits the surface, in [0, 1]: that of a blend is the mean of its parts', times
// its own.
float opacity_at(const Material& material, const std::vector<Material>& all,
                 const std::vector<Texture>& textures, Vec2 uv);

// The material that scatters light which hits `material`: itself, or a part of the blend. `u` in [0, 1)
// chooses among the parts in proportion to what of their weight is opaque.
const Material& scatterer_at(const Material& material, const std::vector<Material>& all,
                             const std::vector<Texture>& textures, Vec2 uv, float u);

}  // namespace tessera::core
