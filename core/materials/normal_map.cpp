#include "core/materials/normal_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tessera::core {
namespace {

// A texture's own scale may mirror the picture; then it grows the other way.
Vec3 along_picture(Vec3 along, float scale) {
  return scale < 0 ? -along : along;
}

}  // namespace

Vec3 bend_by_map(const NormalMap& map, const std::vector<Texture>& textures, Vec2 uv, Vec3 normal,
                 Vec3 along_u, Vec3 along_v) {
  const Texture& texture = textures[static_cast<std::size_t>(map.texture)];
  along_u = along_picture(along_u, texture.scale.x);
  along_v = along_picture(along_v, texture.scale.y);
  // Gram and Schmidt; the frame is left-handed where the texture coordinates are mirrored.
  const Vec3 flat_u = along_u - normal * dot(normal, along_u);
  constexpr float kParallel = 1e-4f;
  if (!(length(flat_u) > kParallel)) return normal;
  const Vec3 tangent = normalize(flat_u);
  const Vec3 bitangent = face_toward(cross(normal, tangent), along_v);
  const Rgb texel = texture.evaluate(uv);
  const float x = map.strength * (2 * texel.r - 1), y = map.strength * (2 * texel.g - 1);
  constexpr float kLeastHeight = 0.05f;
  const float z = std::max(2 * texel.b - 1, kLeastHeight);
  return normalize(tangent * x + bitangent * y + normal * z);
}

}  // namespace tessera::core
