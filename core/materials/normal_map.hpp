// Normals bent by a tangent-space normal map.
#pragma once

#include <vector>

#include "core/materials/material.hpp"
#include "core/math/vec3.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core {

// `normal` bent as the map says at `uv`. Red leans it towards growing u, green towards growing v (the
// convention of OpenGL), of the picture; blue is along the normal. `along_u` and `along_v` are the surface's
// directions of growing texture coordinates; where they are zero or parallel to the normal, it stays as it
// is. All are of unit length.
Vec3 bend_by_map(const NormalMap& map, const std::vector<Texture>& textures, Vec2 uv, Vec3 normal,
                 Vec3 along_u, Vec3 along_v);

}  // namespace tessera::core
