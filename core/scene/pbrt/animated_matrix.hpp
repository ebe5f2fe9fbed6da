// SPDX-License-Identifier: Apache-2.0
// Transformations that differ between the start and the end of a time. Stateless; thread-safe.
#pragma once

#include <optional>

#include "core/scene/import/keyed_transforms.hpp"
#include "core/scene/pbrt/matrix.hpp"

namespace tessera::core::pbrt {

struct AnimatedMatrix {
  Matrix start{}, end{};

  bool moves() const { return start != end; }
  bool operator==(const AnimatedMatrix&) const = default;
};
// Each applies `inner`, then `outer`.
inline AnimatedMatrix operator*(const AnimatedMatrix& outer, const AnimatedMatrix& inner) {
  return {outer.start * inner.start, outer.end * inner.end};
}

// The times of start and end, in seconds.
struct TransformTimes {
  float start_s = 0, end_s = 1;
};

// With a frame for each second, counted from `origin_s`; nullopt if no time lies between.
inline std::optional<KeyedTransforms> keyed_transforms(const AnimatedMatrix& matrix,
                                                       const TransformTimes& times, float origin_s) {
  const float start = times.start_s - origin_s, end = times.end_s - origin_s;
  if (!(start < end)) return std::nullopt;
  return KeyedTransforms{{start, matrix.start.transform()}, {end, matrix.end.transform()}};
}

}  // namespace tessera::core::pbrt
