// SPDX-License-Identifier: Apache-2.0
// Sets of texture coordinates. Meshes have up to two, and each texture says by which it is looked up.
#pragma once

#include "core/math/vec3.hpp"

namespace tessera::core {

enum class UvSet { kFirst, kSecond };

// The texture coordinates of a surface point, by all sets. T is float or FloatN.
template <typename T>
struct UvSetsOf {
  UvSetsOf() = default;
  // Of a surface with one set, which counts as both.
  UvSetsOf(Vec2Of<T> only) : first(only), second(only) {}
  UvSetsOf(Vec2Of<T> of_first, Vec2Of<T> of_second) : first(of_first), second(of_second) {}

  Vec2Of<T> operator[](UvSet set) const { return set == UvSet::kFirst ? first : second; }

  Vec2Of<T> first, second;
};
using UvSets = UvSetsOf<float>;

}  // namespace tessera::core
