// SPDX-License-Identifier: Apache-2.0
// The layout of a film: the named channels of its pixels, and how the samples of each are summed. Whatever
// keeps or sends sums of a tile takes their number and order from the layout.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace tessera::core {

// How samples of a channel become sums. Every encoding is exact and associative.
enum class ChannelEncoding {
  // Two saturating sums in fixed point (fixed_point.hpp): of all samples, and of the odd-numbered ones.
  kRadiance,
};

struct FilmChannel {
  std::string name;
  ChannelEncoding encoding = ChannelEncoding::kRadiance;
  bool operator==(const FilmChannel&) const = default;
};

// In the order of their sums in each pixel.
struct FilmLayout {
  std::vector<FilmChannel> channels;

  // The sums of one kind, of all or of the odd-numbered samples, in so many pixels.
  std::size_t sums(std::size_t pixels) const { return pixels * channels.size(); }
  bool operator==(const FilmLayout&) const = default;
};

// That of FilmTile and Film: R, G and B of the radiance that reaches the camera.
inline const FilmLayout& rgb_layout() {
  static const FilmLayout kRgb{{{"R"}, {"G"}, {"B"}}};
  return kRgb;
}

}  // namespace tessera::core
