// SPDX-License-Identifier: Apache-2.0
// An object of the still life: its mesh and its texture. Lengths are in centimetres, y is up, and objects
// stand on y = 0 at the origin.
#pragma once

#include <string>
#include <vector>

#include "core/image/image.hpp"
#include "core/scene/description.hpp"

namespace tessera::still_life {

struct Model {
  core::MeshDescription mesh;               // empty for a texture by itself
  std::vector<std::string> material_names;  // of mesh.triangle_materials; empty where the scene file says it
  std::string materials_mtl;                // text of the library in which these names are
  core::Image texture;                      // of no pixels where it needs none
};

}  // namespace tessera::still_life
