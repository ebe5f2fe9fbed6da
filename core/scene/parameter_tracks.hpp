// SPDX-License-Identifier: Apache-2.0
// Keyframes of the numbers and colours of materials, media and the environment, by their keys in scene files.
// Of a parameter with a texture, they are those of its factor. Plain data and pure functions.
#pragma once

#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/materials/material.hpp"
#include "core/math/rgb.hpp"
#include "core/math/track.hpp"
#include "core/media/medium_description.hpp"

namespace tessera::core {

// The values over time of the parameter with this key.
template <typename T>
struct KeyedTrack {
  std::string key;
  Track<T> track;
};

struct ParameterTracks {
  std::vector<KeyedTrack<float>> numbers;
  std::vector<KeyedTrack<Rgb>> colors;

  bool empty() const { return numbers.empty() && colors.empty(); }
  // Ignores empty tracks.
  void add(std::string_view key, Track<float> track) { add_to(numbers, key, std::move(track)); }
  void add(std::string_view key, Track<Rgb> track) { add_to(colors, key, std::move(track)); }
  // Null without keyframes.
  const Track<float>* number(std::string_view key) const { return find(numbers, key); }
  const Track<Rgb>* color(std::string_view key) const { return find(colors, key); }

 private:
  template <typename T>
  static void add_to(std::vector<KeyedTrack<T>>& tracks, std::string_view key, Track<T> track) {
    if (!track.empty()) tracks.push_back({std::string(key), std::move(track)});
  }
  template <typename T>
  static const Track<T>* find(const std::vector<KeyedTrack<T>>& tracks, std::string_view key) {
    for (const KeyedTrack<T>& each : tracks)
      if (each.key == key) return &each.track;
    return nullptr;
  }
};

// Of one of SceneDescription::materials or SceneDescription::media.
struct IndexedTracks {
  std::uint32_t index = 0;
  ParameterTracks tracks;
};

// Calls visit(key, value) for each number and colour of a material that can have keyframes.
template <typename Visit>
void visit_values(Material& material, const Visit& visit) {
  visit_parameters(material.model,
                   [&](std::string_view key, auto& parameter) { visit(key, parameter.value); });
  visit("emission", material.emission.value);
  visit("opacity", material.opacity.value);
  visit("normal_map", material.normal_map.strength);
  visit("bump", material.bump.height);
}
template <typename Visit>
void visit_values(MediumDescription& medium, const Visit& visit) {
  visit("sigma_a", medium.sigma_a);
  visit("sigma_s", medium.sigma_s);
  visit("scale", medium.scale);
  visit("g", medium.g);
  visit("emission", medium.emission);
}

// `values`, a material, a medium or an environment, as it is at a frame.
template <typename Values>
Values values_at(Values values, const ParameterTracks& tracks, float frame) {
  visit_values(values, [&]<typename T>(std::string_view key, T& value) {
    if constexpr (std::same_as<T, float>) {
      if (const auto* track = tracks.number(key)) value = value_at(*track, frame, value);
    } else {
      if (const auto* track = tracks.color(key)) value = value_at(*track, frame, value);
    }
  });
  return values;
}

// The least (or greatest) values at any frame.
inline float extreme(float a, float b, bool greatest) {
  return (a < b) == greatest ? b : a;
}
inline Rgb extreme(Rgb a, Rgb b, bool greatest) {
  return {extreme(a.r, b.r, greatest), extreme(a.g, b.g, greatest), extreme(a.b, b.b, greatest)};
}
template <typename Values>
Values extreme_values(Values values, const ParameterTracks& tracks, bool greatest) {
  const auto widen = [greatest](auto& value, const auto* track) {
    if (track == nullptr) return;
    for (const auto& each : track->values) value = extreme(value, each, greatest);
  };
  visit_values(values, [&]<typename T>(std::string_view key, T& value) {
    if constexpr (std::same_as<T, float>) {
      widen(value, tracks.number(key));
    } else {
      widen(value, tracks.color(key));
    }
  });
  return values;
}

}  // namespace tessera::core
