// SPDX-License-Identifier: Apache-2.0
// The byte planes in which sums of a tile are sent and stored: the lowest bytes of all sums, then the second
// bytes, and so on, as a zstd frame. The high bytes of neighbours are similar and the low ones are noise. In
// separate planes they compress several times as fast, and into fewer bytes, as in whole sums. Pure
// functions.
#pragma once

#include <google/protobuf/repeated_field.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"
#include "core/film/layout.hpp"
#include "core/film/planes.hpp"

namespace tessera::proto {

using PlaneSizes = google::protobuf::RepeatedField<std::uint32_t>;

struct TilePlanes {
  // Both have the same size.
  std::vector<std::uint64_t> sums, odd_sums;
  core::Planes planes{};  // of the layers
};

// All words, one list after the other.
std::string encode_planes(const std::vector<std::uint64_t>& sums, const std::vector<std::uint64_t>& odd_sums,
                          const core::Planes& planes = {});
// `count` is the size of each of the two lists of sums. DATA_LOSS if the frame is damaged or has another
// size.
core::Result<TilePlanes> decode_planes(std::string_view frame, std::size_t count,
                                       const PlaneSizes& plane_words = {});

// The sizes of the planes in words.
void add_plane_words(const core::Planes& planes, PlaneSizes& plane_words);
// DATA_LOSS if planes of these sizes cannot be those of a tile with this layout: bounds what decode_planes()
// takes.
core::Status check_plane_words(const PlaneSizes& plane_words, const core::FilmLayout& layout,
                               std::size_t pixels, std::uint32_t samples);

}  // namespace tessera::proto
