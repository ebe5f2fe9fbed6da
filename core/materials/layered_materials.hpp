// SPDX-License-Identifier: Apache-2.0
// The lobes of layered materials at a point, with their textures evaluated.
#pragma once

#include <vector>

#include "core/materials/lobe_mixture.hpp"
#include "core/materials/material.hpp"

namespace tessera::core {

// Where a material is seen.
struct MaterialPoint {
  const std::vector<Texture>& textures;
  Vec2 uv;
  bool outside;  // the viewer is on the side that the outward geometric normal points to
  Rgb tint;      // multiplies the base colour
};

LobeMixture lobes_of(const Principled& model, const MaterialPoint& at);
LobeMixture lobes_of(const Plastic& model, const MaterialPoint& at);
LobeMixture lobes_of(const ConductorMaterial& model, const MaterialPoint& at);
LobeMixture lobes_of(const DiffuseTransmission& model, const MaterialPoint& at);
LobeMixture lobes_of(const ThinDielectric& model, const MaterialPoint& at);

}  // namespace tessera::core
