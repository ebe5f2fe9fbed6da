// SPDX-License-Identifier: Apache-2.0
// Shapes turned into primitives: those of a scene, or those of an object that instances show.
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/primitives.hpp"
#include "core/lights/area_light.hpp"
#include "core/scene/description.hpp"

namespace tessera::core {

struct Model {
  // The two triangles that a quad has become. As a light they are one.
  struct Quad {
    std::uint32_t first;
    QuadLight shape;
  };

  Primitives primitives;
  std::vector<Quad> quads;  // in the order of their triangles
};

// But for instances. Empties the meshes.
Model make_model(std::vector<ShapeDescription>& shapes);

}  // namespace tessera::core
