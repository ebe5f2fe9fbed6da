#include "proto/tile_codec.hpp"

#include <fmt/format.h>
#include <xxhash.h>
#include <zstd.h>
#include <zstd_errors.h>

#include <algorithm>
#include <bit>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "proto/convert.hpp"

namespace tessera::proto {
namespace {

using core::ErrorCode;
using core::fail;

static_assert(std::endian::native == std::endian::little, "the wire order is copied as it lies in memory");

// Sums are noise in their low bits: a higher level costs time and gains nothing.
constexpr int kZstdLevel = 1;

// Of both buffers of the largest tile.
constexpr std::size_t kMostSums = std::size_t{2} * 3 * core::kTilePx * core::kTilePx;

// What coding a tile takes besides its result. Kept for the next: to get that much memory anew, and have it
// filled with zeros, takes as long as decompressing.
struct Workspace {
  std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> compressor{ZSTD_createCCtx(), &ZSTD_freeCCtx};
  std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> decompressor{ZSTD_createDCtx(), &ZSTD_freeDCtx};
  std::vector<std::uint64_t> sums = std::vector<std::uint64_t>(kMostSums);
  std::string frame = std::string(ZSTD_compressBound(kMostSums * sizeof(std::uint64_t)), '\0');

  Workspace() {
    if (!compressor || !decompressor) throw std::bad_alloc();
  }
  void make_room_for(std::size_t sum_count) {
    if (sum_count <= sums.size()) return;
    sums.resize(sum_count);
    frame.resize(ZSTD_compressBound(sum_count * sizeof(std::uint64_t)));
  }
};

Workspace& workspace() {
  thread_local Workspace of_this_thread;
  return of_this_thread;
}

// Into work.sums. The frame must hold exactly so many bytes.
core::Status decompress(const std::string& frame, std::size_t raw_bytes, Workspace& work) {
  const std::size_t written =
      ZSTD_decompressDCtx(work.decompressor.get(), work.sums.data(), raw_bytes, frame.data(), frame.size());
  if (ZSTD_getErrorCode(written) == ZSTD_error_memory_allocation) throw std::bad_alloc();
  if (ZSTD_isError(written) != 0)
    return fail(ErrorCode::kInvalidArgument, fmt::format("sums_zstd: {}", ZSTD_getErrorName(written)));
  if (written != raw_bytes)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("sums_zstd: must hold {} bytes of sums, got {}", raw_bytes, written));
  return {};
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

v1::RenderedItem encode_tile(const core::FilmTile& tile) {
  Workspace& work = workspace();
  work.make_room_for(tile.sums.size() + tile.odd_sums.size());
  const auto end = std::copy(tile.odd_sums.begin(), tile.odd_sums.end(),
                             std::copy(tile.sums.begin(), tile.sums.end(), work.sums.begin()));
  const auto bytes = static_cast<std::size_t>(end - work.sums.begin()) * sizeof(std::uint64_t);
  const std::size_t size = ZSTD_compressCCtx(work.compressor.get(), work.frame.data(), work.frame.size(),
                                             work.sums.data(), bytes, kZstdLevel);
  if (ZSTD_isError(size) != 0) throw std::bad_alloc();  // the only way to fail where the frame has room

  v1::RenderedItem message;
  *message.mutable_item() = to_proto(WorkItem{tile.rect, tile.range});
  message.set_sums_zstd(work.frame.data(), size);
  message.set_sums_xxh3(XXH3_64bits(work.sums.data(), bytes));
  *message.mutable_counters() = to_proto(tile.counters);
  return message;
}

core::Result<core::FilmTile> decode_tile(const v1::RenderedItem& message) {
  const core::Result<WorkItem> item = decode_region(message);
  if (!item) return fail(item.error());
  const std::size_t half = item->rect.pixel_count() * 3;
  Workspace& work = workspace();
  if (core::Status read = decompress(message.sums_zstd(), 2 * half * sizeof(std::uint64_t), work); !read)
    return fail(read.error());
  if (XXH3_64bits(work.sums.data(), 2 * half * sizeof(std::uint64_t)) != message.sums_xxh3())
    return fail(ErrorCode::kInvalidArgument,
                "sums_xxh3: does not match the sums; they were damaged on the way");

  core::FilmTile tile;
  tile.rect = item->rect;
  tile.range = item->range;
  tile.counters = from_proto(message.counters());
  if (core::Status fits = check_counters(tile.counters, *item); !fits) return fail(fits.error());
  const auto middle = work.sums.begin() + static_cast<std::ptrdiff_t>(half);
  tile.sums.assign(work.sums.begin(), middle);
  tile.odd_sums.assign(middle, middle + static_cast<std::ptrdiff_t>(half));
  return tile;
}

}  // namespace tessera::proto
