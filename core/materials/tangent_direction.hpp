// SPDX-License-Identifier: Apache-2.0
// Directions on a surface, by its texture coordinates. Stateless.
#pragma once

#include <algorithm>

#include "core/math/elementary.hpp"
#include "core/math/vec3.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core {

// A direction from a texture: red and green are its components from -1 to 1 along growing u and v of the
// image.
struct TangentMap {
  int texture = -1;  // index among the scene's textures, -1 for none
};

// The direction along which highlights of anisotropic microfacets are stretched: that of the map, or of
// growing u without one, turned by an angle.
struct TangentDirection {
  TangentMap map{};
  ScalarParameter rotation = 0;  // from increasing u towards increasing v; 1 is a whole rotation
};

inline bool is_along_u(const TangentDirection& direction) {
  return direction.map.texture < 0 && direction.rotation.texture < 0 && direction.rotation.value == 0;
}

// The components of a direction along growing u and v.
inline Vec2 direction_in_texel(Rgb texel) {
  return {2 * texel.r - 1, 2 * texel.g - 1};
}
inline Vec2 turned(Vec2 v, float turns) {
  constexpr float kMaxTurns = 1e6f;
  const auto [s, c] = sin_cos_turns(std::clamp(turns, -kMaxTurns, kMaxTurns));
  return {c * v.x - s * v.y, s * v.x + c * v.y};
}

// The vector with these components in the plane of `normal`, along growing u and across it towards growing v.
// Zero if the directions are zero or parallel to the normal. The normal and the directions have unit length.
inline Vec3 direction_in_plane(Vec2 components, Vec3 normal, Vec3 along_u, Vec3 along_v) {
  const Vec3 flat_u = along_u - normal * dot(normal, along_u);
  constexpr float kParallel = 1e-4f;
  if (!(length(flat_u) > kParallel)) return {};
  const Vec3 tangent = normalize(flat_u);
  return tangent * components.x + face_toward(cross(normal, tangent), along_v) * components.y;
}

}  // namespace tessera::core
