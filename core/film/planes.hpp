// SPDX-License-Identifier: Apache-2.0
// The planes of a film tile: the sums of its channels besides R, G and B (layout.hpp). Pure functions.
//
// A plane of kIds is a list of entries of two words: the number of the pixel in its rectangle, row by row, in
// the upper 32 bits of the first word and the id, which is not 0, in the lower ones; and the number of
// samples with it, which is not 0. Entries are sorted by their first words, and no two have the same. Of more
// than kMaxIdsPerPixel ids, a pixel keeps those that come first in a pseudorandom order, which depends on the
// pixel's place in the image and the ids alone. An id among the first of all samples is among the first of
// any part of them, so that its count is exact, and what is kept does not depend on how the samples were cut
// up.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/error.hpp"
#include "core/film/layout.hpp"
#include "core/film/region.hpp"

namespace tessera::core {

using Plane = std::vector<std::uint64_t>;
// In the order of FilmLayout::plane(). Empty in a film without them, or without samples.
using Planes = std::vector<Plane>;

inline constexpr std::size_t kMaxIdsPerPixel = 64;

// The unit of kSigned, and the largest magnitude of a sample in it.
inline constexpr double kSignedUnit = 0x1p-20;
inline constexpr std::int64_t kMaxSignedSample = (std::int64_t{1} << 39) - 1;

// One sample. NaN becomes 0.
std::uint64_t to_signed_word(double value);
// The mean of the samples whose words were added; 0 where there are none.
double mean_signed(std::uint64_t sum, std::uint32_t samples);

// `distance` must not be negative.
std::uint64_t to_nearest_word(float distance, std::uint32_t number);
// Infinity if the word is 0.
float nearest_distance(std::uint64_t word);
inline std::uint32_t nearest_number(std::uint64_t word) {
  return static_cast<std::uint32_t>(word);
}

// Adds one word of a plane that is not of kIds.
std::uint64_t combine(ChannelEncoding encoding, std::uint64_t a, std::uint64_t b);

// Empties a plane whose words are all 0, so that equal sums have equal planes.
void drop_zeros(Plane& plane);

// Adds planes of a rectangle to those of a rectangle that it contains, or the same one. `to` may be empty.
// The planes of `from` must be those of the layout, or none.
void add_planes(const FilmLayout& layout, Planes& to, const PixelRect& to_rect, const Planes& from,
                const PixelRect& from_rect);

// Whether some number of samples of each pixel of a rectangle could have these planes: for planes of others.
// Bounds their memory, too.
Status check_planes(const FilmLayout& layout, const Planes& planes, const PixelRect& rect,
                    std::uint32_t samples);

// Counts ids sample by sample. Not thread-safe.
class IdCounter {
 public:
  // `pixel` is its number in `rect`, the rectangle of the tile.
  explicit IdCounter(const PixelRect& rect) : rect_(rect) {}

  // An id of 0 is none.
  void add(std::uint32_t pixel, std::uint32_t id);
  // The plane of all that was added; nothing remains.
  Plane take();

 private:
  struct Entry {
    std::uint64_t key, count;
  };
  void compact();

  PixelRect rect_;
  std::vector<Entry> entries_;
  std::size_t compact_at_ = std::size_t{1} << 14;
};

}  // namespace tessera::core
