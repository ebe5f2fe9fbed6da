// SPDX-License-Identifier: Apache-2.0
// Converts shapes to primitives: those of a scene, or of an instanced object.
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/primitives.hpp"
#include "core/lights/area_light.hpp"
#include "core/scene/description.hpp"
#include "core/scene/scene_ids.hpp"

namespace tessera::core {

struct Model {
  // The two triangles of a quad. They form a single light.
  struct Quad {
    std::uint32_t first;
    lights::QuadLight shape;
  };

  Primitives primitives;
  std::vector<Quad> quads;  // in the order of their triangles
  std::vector<ShapeStart> starts{};
};

// Converts all shapes except instances. Empties the meshes.
Model make_model(std::vector<ShapeDescription>& shapes);

}  // namespace tessera::core
