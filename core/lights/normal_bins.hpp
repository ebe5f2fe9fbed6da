// SPDX-License-Identifier: Apache-2.0
// Quantises a surface normal into an index for tables: one of the squares of an octahedral map, or all
// sides at once.
#pragma once

#include "core/math/octahedral_map.hpp"
#include "core/math/word_lanes.hpp"

namespace tessera::core::lights {

inline constexpr int kFacingsAcross = 12;
inline constexpr std::uint32_t kAllSides = kFacingsAcross * kFacingsAcross;
inline constexpr std::uint32_t kFacings = kAllSides + 1;

// The bin of a unit normal, or of zero: LightSampleContext::normal.
template <typename T = float>
WordOf<T> normal_bin(Vec3Of<T> normal) {
  constexpr auto kAcross = static_cast<float>(kFacingsAcross);
  const Vec2Of<T> square = to_octahedral_square(normal);
  const auto number = [](T x) { return to_word(larger(T(0.0f), smaller(x * kAcross, T(kAcross - 1)))); };
  const MaskOf<T> none = (normal.x == 0) & (normal.y == 0) & (normal.z == 0);
  return select(none, WordOf<T>(kAllSides),
                number(square.y) * WordOf<T>(std::uint32_t{kFacingsAcross}) + number(square.x));
}

// A normal of a bin other than all sides, at (x, y) in [0, 1] x [0, 1] of its square.
inline Vec3 bin_normal(std::uint32_t facing, Vec2 place) {
  const Vec2 corner{static_cast<float>(facing % kFacingsAcross), static_cast<float>(facing / kFacingsAcross)};
  return from_octahedral_square<float>((corner + place) * (1.0f / kFacingsAcross));
}

}  // namespace tessera::core::lights
