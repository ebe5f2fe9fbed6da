// SPDX-License-Identifier: Apache-2.0
#include "server/film/plausible.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/film/layout.hpp"
#include "core/film/planes.hpp"

namespace tessera::film {

using core::ErrorCode;
using core::fail;

namespace {

core::Status check_first_non_finite(const core::FilmTile& tile) {
  const auto& id = tile.counters.first_non_finite;
  const core::PixelRect& rect = tile.rect;
  if (id.has_value() != (tile.counters.non_finite_samples > 0)) {
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format(
            "counters.first_non_finite: must be there if and only if there are such samples, of which "
            "there are {}",
            tile.counters.non_finite_samples));
  }
  if (!id || (id->x >= rect.x0 && id->x < rect.x1 && id->y >= rect.y0 && id->y < rect.y1 &&
              id->sample >= tile.range.begin && id->sample < tile.range.end)) {
    return {};
  }
  return fail(ErrorCode::kInvalidArgument, "counters.first_non_finite: is no sample of this item");
}

struct OddCounts {
  bool none = false, all = false;  // whether none, or all, of the samples are odd
};

bool is_possible(std::uint64_t sum, std::uint64_t odd, const OddCounts& counts) {
  return odd <= sum && (!counts.none || odd == 0) && (!counts.all || odd == sum);
}

// The same of all sums, without a branch for each.
bool are_possible(const core::FilmTile& tile, const OddCounts& counts) {
  std::uint64_t above = 0, odd = 0, different = 0;
  for (std::size_t i = 0; i < tile.sums.size(); ++i) {
    above |= static_cast<std::uint64_t>(tile.odd_sums[i] > tile.sums[i]);
    odd |= tile.odd_sums[i];
    different |= tile.odd_sums[i] ^ tile.sums[i];
  }
  return above == 0 && (!counts.none || odd == 0) && (!counts.all || different == 0);
}

// The sums of the odd samples, which are a subset of all samples.
core::Status check_odd_sums(const core::FilmTile& tile) {
  const OddCounts counts{tile.range.odd_count() == 0, tile.range.odd_count() == tile.range.count()};
  if (are_possible(tile, counts)) return {};
  std::size_t i = 0;
  while (is_possible(tile.sums[i], tile.odd_sums[i], counts)) ++i;
  return fail(
      ErrorCode::kInvalidArgument,
      fmt::format("sums: number {} is {}, and that of its {} odd-numbered samples {}, which cannot be", i,
                  tile.sums[i], tile.range.odd_count(), tile.odd_sums[i]));
}

// A saturated sample, or one that is black because it was not finite, is counted.
core::Status check_counted(const core::FilmTile& tile) {
  const auto is_saturated = [](std::uint64_t sum) { return sum == core::kFilmSaturated; };
  if (tile.counters.saturated_samples > 0 && std::none_of(tile.sums.begin(), tile.sums.end(), is_saturated)) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("counters.saturated_samples: is {}, but no sum has reached the end of its range",
                            tile.counters.saturated_samples));
  }
  const bool all_black = tile.counters.non_finite_samples == tile.counters.samples;
  if (all_black &&
      std::any_of(tile.sums.begin(), tile.sums.end(), [](std::uint64_t sum) { return sum > 0; })) {
    return fail(ErrorCode::kInvalidArgument,
                "counters.non_finite_samples: are all samples there are, but some are not black");
  }
  return {};
}

}  // namespace

core::Status check_plausible(const core::FilmTile& tile) {
  const core::FilmLayout layout = core::film_layout(tile.layers);
  if (auto valid = core::check_planes(layout, tile.planes, tile.rect, tile.range.count()); !valid)
    return core::fail(ErrorCode::kInvalidArgument, valid.error().message);
  if (auto valid = check_first_non_finite(tile); !valid) return valid;
  if (auto valid = check_odd_sums(tile); !valid) return valid;
  return check_counted(tile);
}

}  // namespace tessera::film
