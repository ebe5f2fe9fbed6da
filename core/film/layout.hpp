// SPDX-License-Identifier: Apache-2.0
// The layout of a film: the named channels of its pixels, and how the samples of each are summed. Whatever
// keeps or sends sums of a tile takes their number and order from the layout, which follows from the layers
// of the render.
//
// In memory (FilmTile, Film::TileSums), a tile of n pixels has
//  - `sums` and `odd_sums` for the channels R, G and B (kRadiance): 3 n words of 64 bits each, of all and of
//    the odd-numbered samples, row by row, the channels of a pixel side by side. A film without other
//    channels has nothing else.
//  - `planes`, one for each further channel in the order of the layout: n words row by row, or none if all
//    are 0; for kIds a list of entries (planes.hpp).
// Without samples, every word of every encoding is 0, and adding a word of 0 changes nothing. On the wire and
// on disk a tile is these words in this order, with the length of each plane: R, G and B are where they were
// before there were layers. Sums of a tile may be cut into ranges of samples in any way and added in any
// order: each encoding is exact, associative and commutative.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "core/film/layers.hpp"

namespace tessera::core {

enum class ChannelEncoding {
  // Two saturating sums in fixed point (fixed_point.hpp): of all samples, and of the odd-numbered ones.
  kRadiance,
  // A saturating sum in the same fixed point, of all samples: values that are not negative.
  kSum,
  // A two's-complement sum in units of 2^-20. Each sample is clamped so that 2^24 of them cannot overflow.
  kSigned,
  // The number of samples.
  kCount,
  // A maximum: in the upper 32 bits the complement of the bits of a float that is not negative, so that the
  // smallest one wins; in the lower 32 bits a number that belongs to it, or 0. Of equally small floats the
  // larger number wins.
  kNearest,
  // The ids of the samples, with the number of samples of each. A pixel keeps at most kMaxIdsPerPixel of
  // them, by a rule that does not depend on the order (planes.hpp).
  kIds,
};

struct FilmChannel {
  std::string name;
  ChannelEncoding encoding = ChannelEncoding::kRadiance;
  bool operator==(const FilmChannel&) const = default;
};

// In the order of their sums in each pixel.
struct FilmLayout {
  std::vector<FilmChannel> channels;

  // The sums of one kind, of all or of the odd-numbered samples, in so many pixels, of the channels of
  // kRadiance.
  std::size_t sums(std::size_t pixels) const { return pixels * radiance_channels(); }
  std::size_t radiance_channels() const;
  // The channels with planes: all but those of kRadiance, which come first.
  std::size_t planes() const { return channels.size() - radiance_channels(); }
  const FilmChannel& plane(std::size_t index) const { return channels[radiance_channels() + index]; }
  bool operator==(const FilmLayout&) const = default;
};

// R, G and B of the radiance that reaches the camera.
const FilmLayout& rgb_layout();

// R, G and B, and the channels of the layers. kSamples and kStandardError have none: they follow from the
// others.
FilmLayout film_layout(const LayerSet& layers);

// The first plane of a layer that is among `layers`, and has channels in the film; those of its further
// channels follow.
std::size_t first_plane(const LayerSet& layers, Layer layer);
// The same of one of the light groups of `layers`, by its index there.
std::size_t first_group_plane(const LayerSet& layers, std::size_t group);
// "Combined_NAME", of which ".R", ".G" and ".B" are the channels of a light group.
std::string group_channel(std::string_view group);

}  // namespace tessera::core
