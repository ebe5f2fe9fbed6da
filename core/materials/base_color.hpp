// SPDX-License-Identifier: Apache-2.0
// The base colour of a surface for the albedo layer: one colour for each material, whatever its angles. Pure.
#pragma once

#include <vector>

#include "core/materials/material.hpp"

namespace tessera::core {

// In [0, 1]: the diffuse reflectance plus the specular reflectance at normal incidence (the whole tint of
// mirrors and microfacets over nothing); of what transmits light, the sum of reflection's and transmission's
// colours, so that clear glass is white. Principled: base colour by its weight, or the transmission's colour.
// Disney: base colour. Hair: the colour of much of it. Black for Null, and for a Blend, whose parts are to be
// asked. `tint` is the vertex colour.
Rgb base_color_at(const Material& material, const std::vector<Texture>& textures, const TexturePoint& point,
                  Rgb tint);

}  // namespace tessera::core
