// SPDX-License-Identifier: Apache-2.0
#include "proto/tile_codec.hpp"

#include <fmt/format.h>
#include <xxhash.h>
#include <zstd.h>
#include <zstd_errors.h>

#include <bit>
#include <memory>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "core/film/layout.hpp"
#include "proto/convert.hpp"
#include "proto/tile_planes.hpp"

namespace tessera::proto {
namespace {

using core::ErrorCode;
using core::fail;

static_assert(std::endian::native == std::endian::little, "the wire order is copied as it lies in memory");

// The state is large and must be aligned, so each thread keeps one.
struct HashState {
  std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state{XXH3_createState(), &XXH3_freeState};

  HashState() {
    if (!state) throw std::bad_alloc();
  }
};

// The checksum of all words in order.
std::uint64_t checksum(const std::vector<std::uint64_t>& sums, const std::vector<std::uint64_t>& odd_sums,
                       const core::Planes& planes) {
  thread_local const HashState kept;
  XXH3_64bits_reset(kept.state.get());
  const auto add = [](const std::vector<std::uint64_t>& words) {
    XXH3_64bits_update(kept.state.get(), words.data(), words.size() * sizeof(std::uint64_t));
  };
  add(sums);
  add(odd_sums);
  for (const core::Plane& plane : planes) add(plane);
  return XXH3_64bits_digest(kept.state.get());
}

// Decodes the format of earlier builds, with whole sums one after the other. `count` is the size
// of each half.
core::Result<TilePlanes> decode_in_a_row(const std::string& frame, std::size_t count) {
  std::vector<std::uint64_t> sums(2 * count);
  const std::size_t raw_bytes = sums.size() * sizeof(std::uint64_t);
  const std::size_t written = ZSTD_decompress(sums.data(), raw_bytes, frame.data(), frame.size());
  if (ZSTD_getErrorCode(written) == ZSTD_error_memory_allocation) throw std::bad_alloc();
  if (ZSTD_isError(written) != 0 || written != raw_bytes)
    return fail(ErrorCode::kDataLoss, fmt::format("its sums are no complete frame of {} bytes", raw_bytes));
  const auto middle = sums.begin() + static_cast<std::ptrdiff_t>(count);
  std::vector<std::uint64_t> odd_sums(middle, sums.end());
  sums.resize(count);
  return TilePlanes{std::move(sums), std::move(odd_sums)};
}

core::Result<TilePlanes> decode_sums(const v1::RenderedItem& message, const core::FilmLayout& layout,
                                     const WorkItem& item) {
  const std::size_t pixels = item.rect.pixel_count(), count = layout.sums(pixels);
  if (auto fit = check_plane_words(message.plane_words(), layout, pixels, item.range.count()); !fit)
    return fail(ErrorCode::kInvalidArgument, fmt::format("plane_words: {}", fit.error().message));
  const bool in_a_row = message.planes_zstd().empty() && !message.sums_zstd().empty();
  auto sums = in_a_row && layout.planes() == 0
                  ? decode_in_a_row(message.sums_zstd(), count)
                  : decode_planes(message.planes_zstd(), count, message.plane_words());
  if (sums) return sums;
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("{}: {}", in_a_row ? "sums_zstd" : "planes_zstd", sums.error().message));
}

core::Result<WorkItem> decode_region(const v1::RenderedItem& message) {
  core::Result<WorkItem> item = from_proto(message.item());
  if (item && (item->rect.width() > core::kTilePx || item->rect.height() > core::kTilePx))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("rect: must lie in one tile of {} px a side, got {} x {}", core::kTilePx,
                            item->rect.width(), item->rect.height()));
  return item;
}

core::Status check_counters(const core::RenderCounters& counters, const WorkItem& item) {
  const std::uint64_t samples = item.rect.pixel_count() * std::uint64_t{item.range.count()};
  if (counters.samples != samples)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("counters.samples: must be {}, got {}", samples, counters.samples));
  if (counters.non_finite_samples > samples || counters.saturated_samples > samples)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("counters: {} non-finite and {} saturated of {} samples",
                            counters.non_finite_samples, counters.saturated_samples, samples));
  return {};
}

}  // namespace

v1::RenderedItem encode_tile(const core::FilmTile& tile, std::uint32_t image) {
  v1::RenderedItem message;
  *message.mutable_item() = to_proto(WorkItem{tile.rect, tile.range, image});
  message.set_planes_zstd(encode_planes(tile.sums, tile.odd_sums, tile.planes));
  add_plane_words(tile.planes, *message.mutable_plane_words());
  message.set_sums_xxh3(checksum(tile.sums, tile.odd_sums, tile.planes));
  *message.mutable_counters() = to_proto(tile.counters);
  return message;
}

core::Result<core::FilmTile> decode_tile(const v1::RenderedItem& message, core::LayerSet layers) {
  const core::Result<WorkItem> item = decode_region(message);
  if (!item) return fail(item.error());
  auto read = decode_sums(message, core::film_layout(layers), *item);
  if (!read) return fail(read.error());
  if (checksum(read->sums, read->odd_sums, read->planes) != message.sums_xxh3())
    return fail(ErrorCode::kInvalidArgument,
                "sums_xxh3: does not match the sums; they were damaged on the way");
  core::FilmTile tile;
  tile.rect = item->rect;
  tile.range = item->range;
  tile.sums = std::move(read->sums);
  tile.odd_sums = std::move(read->odd_sums);
  tile.layers = layers;
  tile.planes = std::move(read->planes);
  tile.counters = from_proto(message.counters());
  if (core::Status fits = check_counters(tile.counters, *item); !fits) return fail(fits.error());
  return tile;
}

std::uint64_t claimed_bytes(const v1::RenderedItem& message) {
  const auto item = decode_region(message);
  std::uint64_t words = item ? 2 * core::rgb_layout().sums(item->rect.pixel_count()) : 0;
  for (const std::uint32_t of_plane : message.plane_words()) words += of_plane;
  return words * sizeof(std::uint64_t);
}

}  // namespace tessera::proto
