// SPDX-License-Identifier: Apache-2.0
// Keyframed values. Numbers, points and colours are interpolated linearly between two keyframes, rotations by
// slerp; before the first keyframe and after the last one, values are constant. Plain data and pure
// functions.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/math/quaternion.hpp"

namespace tessera::core {

// The values of a parameter over time. Empty if the parameter is not animated.
template <typename T>
struct Track {
  std::vector<float> frames;  // increasing
  std::vector<T> values;      // one for each frame

  bool empty() const { return frames.empty(); }
};

template <typename T>
T interpolate(T a, T b, float t) {
  return a + (b - a) * t;
}
inline Quaternion interpolate(Quaternion a, Quaternion b, float t) {
  return slerp(a, b, t);
}

// The value at a frame; `otherwise` if the parameter is not animated. At a keyframe it is exactly the
// keyframe's.
template <typename T>
T value_at(const Track<T>& track, float frame, T otherwise) {
  if (track.empty()) return otherwise;
  const auto after = std::upper_bound(track.frames.begin(), track.frames.end(), frame);
  if (after == track.frames.begin()) return track.values.front();
  if (after == track.frames.end()) return track.values.back();
  const auto next = static_cast<std::size_t>(after - track.frames.begin());
  const float begin = track.frames[next - 1];
  return interpolate(track.values[next - 1], track.values[next],
                     (frame - begin) / (track.frames[next] - begin));
}

// The frames during which a camera's shutter is open.
struct FrameInterval {
  float begin = 0, end = 0;

  bool empty() const { return !(begin < end); }
  // The frame at `time`, from 0 when the shutter opens to 1 when it closes.
  float at(float time) const {
    const double first = double{begin}, last = double{end};
    return static_cast<float>(first + (last - first) * double{time});
  }
};

}  // namespace tessera::core
