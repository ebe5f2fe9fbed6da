#include "proto/tile_codec.hpp"

#include <fmt/format.h>
#include <xxhash.h>
#include <zstd.h>

#include <bit>
#include <cstring>
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

// Bytes of one of the two buffers of sums.
std::size_t sums_bytes(const core::PixelRect& rect) {
  return rect.pixel_count() * 3 * sizeof(std::uint64_t);
}

std::string compress(const std::string& raw) {
  std::string frame(ZSTD_compressBound(raw.size()), '\0');
  frame.resize(ZSTD_compress(frame.data(), frame.size(), raw.data(), raw.size(), kZstdLevel));
  return frame;
}

core::Result<std::string> decompress(const std::string& frame, std::size_t raw_bytes) {
  std::string raw(raw_bytes, '\0');
  const std::size_t written = ZSTD_decompress(raw.data(), raw.size(), frame.data(), frame.size());
  if (ZSTD_isError(written) != 0)
    return fail(ErrorCode::kInvalidArgument, fmt::format("sums_zstd: {}", ZSTD_getErrorName(written)));
  if (written != raw_bytes)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("sums_zstd: must hold {} bytes of sums, got {}", raw_bytes, written));
  return raw;
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
  const std::size_t half = sums_bytes(tile.rect);
  std::string raw(2 * half, '\0');
  std::memcpy(raw.data(), tile.sums.data(), half);
  std::memcpy(raw.data() + half, tile.odd_sums.data(), half);

  v1::RenderedItem message;
  *message.mutable_item() = to_proto(WorkItem{tile.rect, tile.range});
  message.set_sums_zstd(compress(raw));
  message.set_sums_xxh3(XXH3_64bits(raw.data(), raw.size()));
  *message.mutable_counters() = to_proto(tile.counters);
  return message;
}

core::Result<core::FilmTile> decode_tile(const v1::RenderedItem& message) {
  const core::Result<WorkItem> item = decode_region(message);
  if (!item) return fail(item.error());
  const std::size_t half = sums_bytes(item->rect);
  const core::Result<std::string> raw = decompress(message.sums_zstd(), 2 * half);
  if (!raw) return fail(raw.error());
  if (XXH3_64bits(raw->data(), raw->size()) != message.sums_xxh3())
    return fail(ErrorCode::kInvalidArgument,
                "sums_xxh3: does not match the sums; they were damaged on the way");

  core::FilmTile tile(item->rect, item->range);
  tile.counters = from_proto(message.counters());
  if (core::Status fits = check_counters(tile.counters, *item); !fits) return fail(fits.error());
  std::memcpy(tile.sums.data(), raw->data(), half);
  std::memcpy(tile.odd_sums.data(), raw->data() + half, half);
  return tile;
}

}  // namespace tessera::proto
