// SPDX-License-Identifier: Apache-2.0
// Where textures are looked up: the texture coordinates of a surface point, the point itself, and its normal.
#pragma once

#include "core/math/uv_sets.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core {

// T is float or FloatN.
template <typename T>
struct TexturePointOf {
  TexturePointOf() = default;
  TexturePointOf(Vec2Of<T> only) : uv(only) {}
  TexturePointOf(const UvSetsOf<T>& sets, Vec3Of<T> in_world = {}, Vec3Of<T> outward = {})
      : uv(sets), position(in_world), normal(outward) {}

  UvSetsOf<T> uv;
  Vec3Of<T> position{};  // in world space
  Vec3Of<T> normal{};    // geometric, unit, in world space
};
using TexturePoint = TexturePointOf<float>;

}  // namespace tessera::core
