// SPDX-License-Identifier: Apache-2.0
// Makes textures of the attributes of meshes. Not thread-safe.
#pragma once

#include "core/scene/mitsuba/meshes.hpp"
#include "core/scene/mitsuba/textures.hpp"

namespace tessera::core::mitsuba {

// Gives each triangle its own vertices, and its own block of texels in images of the attributes; the texture
// coordinates of the mesh become those of the blocks. The names are Mitsuba's: "heat_x", "heat_y" and
// "heat_z" of vertices are "vertex_heat", as with the ends "0", "1" and "2"; "albedo_r", "albedo_g" and
// "albedo_b" are "vertex_albedo_color"; "r", "g" and "b" are "vertex_color". Those of triangles begin with
// "face_". Values below 0 become 0. Exact otherwise: lookups interpolate as triangles do. A limit that is
// exceeded is an error in `conversion`.
AttributeTextures make_attribute_textures(Conversion& conversion, const Plugin& shape, ShapeMesh& mesh);

// The means of the attributes as constant textures, for meshes that need their own texture coordinates.
AttributeTextures mean_attributes(Conversion& conversion, const ShapeMesh& mesh);

}  // namespace tessera::core::mitsuba
