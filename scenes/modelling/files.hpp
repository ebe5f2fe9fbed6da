// SPDX-License-Identifier: Apache-2.0
// What was modelled, as files: meshes as OBJ text, textures from functions of their coordinates.
// Stateless; thread-safe.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/image/image.hpp"
#include "core/scene/description.hpp"

namespace tessera::modelling {

// OBJ text of a mesh that has normals and may have uvs; places to 1e-5, normals to 1e-4. Triangles are
// grouped by material: `material_names[i]`, from the library file `mtl_file`, is that of triangle_materials
// i. With no names, the text mentions neither.
std::string obj_text(const core::MeshDescription& mesh, const std::vector<std::string>& material_names = {},
                     const std::string& mtl_file = {});

// A texture of the given size in pixels from its colour at (u, v), v upwards, both in (0, 1).
core::Image paint(int width, int height, const std::function<core::Rgb(float u, float v)>& color);

// The linear colour of 0xRRGGBB as written in style sheets (sRGB).
core::Rgb srgb(unsigned hex);

}  // namespace tessera::modelling
