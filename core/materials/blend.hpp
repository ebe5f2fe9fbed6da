// SPDX-License-Identifier: Apache-2.0
// Which light a surface lets pass straight through, and which material scatters the rest. Blends are resolved
// at a point: one part scatters, chosen by a random number, so that every part keeps its own BSDF, maps and
// sampling. `all` are the scene's materials.
#pragma once

#include <vector>

#include "core/materials/material.hpp"

namespace tessera::core {

// What a surface does to a straight ray of light.
struct Interception {
  float hit = 1;        // the probability that the light is scattered, in [0, 1]
  Rgb transmittance{};  // the share that passes straight through
};

// `cosine` is that of the angle between the ray and the shading normal, in [0, 1]; `from_behind` is whether
// the ray comes from the side that the geometric normal points away from. A blend does the mean of what its
// parts do.
Interception interception_at(const Material& material, const std::vector<Material>& all,
                             const std::vector<Texture>& textures, const TexturePoint& point, float cosine,
                             bool from_behind = false);

// The material that scatters light which hits `material`: itself, or a part of the blend. `u` in [0, 1)
// chooses among the parts in proportion to what of their weight is hit.
const Material& scatterer_at(const Material& material, const std::vector<Material>& all,
                             const std::vector<Texture>& textures, const TexturePoint& point, float cosine,
                             float u, bool from_behind = false);

}  // namespace tessera::core
