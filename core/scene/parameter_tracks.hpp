// SPDX-License-Identifier: Apache-2.0
// Keyframes of the numbers and colours of materials, media and the environment, by their keys in scene files.
// Of a parameter with a texture, they are those of its factor. Plain data and pure functions.
#pragma once

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

struct EnvironmentDescription;

// As they are at a frame.
Material values_at(const Material& material, const ParameterTracks& tracks, float frame);
MediumDescription values_at(const MediumDescription& medium, const ParameterTracks& tracks, float frame);
EnvironmentDescription values_at(const EnvironmentDescription& environment, const ParameterTracks& tracks,
                                 float frame);

// The least (or greatest) values at any frame.
Material extreme_values(const Material& material, const ParameterTracks& tracks, bool greatest);
MediumDescription extreme_values(const MediumDescription& medium, const ParameterTracks& tracks,
                                 bool greatest);
EnvironmentDescription extreme_values(const EnvironmentDescription& environment,
                                      const ParameterTracks& tracks, bool greatest);

}  // namespace tessera::core
