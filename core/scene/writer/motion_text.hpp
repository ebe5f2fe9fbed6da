// SPDX-License-Identifier: Apache-2.0
// Transforms and keyframes as scene files write them. Stateless; thread-safe.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/math/transform.hpp"
#include "core/scene/animation.hpp"
#include "core/scene/writer/json_text.hpp"

namespace tessera::core {

// A list of one step, a matrix.
std::string transform_text(const Transform& transform);
std::string motion_text(const std::vector<MotionStep>& steps);

// The keyframes, each value written by `text`.
template <typename T, typename Text>
std::string keyframes_text(const Track<T>& track, const Text& text) {
  std::vector<std::string> keyframes;
  for (std::size_t i = 0; i < track.frames.size(); ++i)
    keyframes.push_back(json_text::Object()
                            .add("frame", json_text::number(track.frames[i]))
                            .add("value", text(track.values[i]))
                            .on_one_line());
  return json_text::Object().add("keyframes", json_text::list(keyframes)).on_one_line();
}

// The keyframes of a parameter, or none.
const Track<float>& number_track(const ParameterTracks& tracks, std::string_view key);
const Track<Rgb>& color_track(const ParameterTracks& tracks, std::string_view key);

// A parameter that may be animated; without keyframes it is `value`.
template <typename T, typename Text>
std::string animated_text(const T& value, const Track<T>& track, const Text& text) {
  return track.empty() ? text(value) : keyframes_text(track, text);
}

}  // namespace tessera::core
