// SPDX-License-Identifier: Apache-2.0
#include "server/film/tile_row.hpp"

#include <fmt/format.h>

#include <utility>

#include "proto/convert.hpp"
#include "proto/tile_codec.hpp"
#include "proto/tile_planes.hpp"

namespace tessera::film {

namespace {

// Content without this mark is from an earlier release: a RenderedItem as sent over the network then.
constexpr char kPlanesMark = 'P';

struct SampleCount {
  std::uint32_t all = 0, odd = 0;
};

SampleCount count_samples(const std::vector<core::SampleRange>& ranges) {
  SampleCount count;
  for (const core::SampleRange& range : ranges) {
    count.all += range.count();
    count.odd += range.odd_count();
  }
  return count;
}

// `rect` is the expected rectangle of the item.
core::Result<core::FilmTile> decode_item_in_planes(const v1::RenderedItem& message,
                                                   const core::PixelRect& rect) {
  const auto item = proto::from_proto(message.item());
  if (!item) return core::fail(item.error());
  auto planes = proto::decode_planes(message.sums_zstd(), rect.pixel_count() * 3);
  if (!planes) return core::fail(planes.error());
  core::FilmTile tile;
  tile.rect = item->rect;
  tile.range = item->range;
  tile.sums = std::move(planes->sums);
  tile.odd_sums = std::move(planes->odd_sums);
  tile.counters = proto::from_proto(message.counters());
  if (tile.counters.samples != rect.pixel_count() * std::uint64_t{tile.range.count()})
    return core::fail(core::ErrorCode::kDataLoss, "its counters are of other samples");
  return tile;
}

}  // namespace

// The content is a mark that no message begins with, then a rendered item with its sums in planes
// (tile_planes.hpp). `done` says which samples it holds; the item's own range only has their number.
store::TileRow encode_tile_row(const std::string& job_id, int tile, const core::PixelRect& rect,
                               std::vector<core::SampleRange> done, const TileContent& content) {
  v1::RenderedItem message;
  *message.mutable_item() = proto::to_proto(proto::WorkItem{rect, {0, count_samples(done).all}});
  message.set_sums_zstd(proto::encode_planes(content.sums.sums, content.sums.odd_sums));
  *message.mutable_counters() = proto::to_proto(content.counters);
  std::string bytes(1, kPlanesMark);
  message.AppendToString(&bytes);
  bytes += encode_provenance(content.provenance);
  return {job_id, tile, std::move(done), std::move(bytes)};
}

core::Result<TileContent> decode_tile_row(const store::TileRow& row, const core::PixelRect& rect) {
  const auto damaged = [&](const std::string& how) {
    return core::fail(core::ErrorCode::kDataLoss,
                      fmt::format("the stored tile {} of job {} is damaged ({})", row.tile, row.job_id, how));
  };
  if (row.done.empty()) return TileContent{};  // all samples were removed again
  const bool in_planes = !row.content.empty() && row.content.front() == kPlanesMark;
  const std::string bytes = in_planes ? row.content.substr(1) : row.content;
  v1::RenderedItem message;
  if (!message.ParseFromString(bytes)) return damaged("not a rendered item");
  auto item = in_planes ? decode_item_in_planes(message, rect) : proto::decode_tile(message);
  if (!item) return damaged(item.error().message);
  const SampleCount count = count_samples(row.done);
  if (item->rect != rect || item->range.count() != count.all) return damaged("of another rectangle or range");
  return TileContent{{std::move(item->sums), std::move(item->odd_sums), count.all, count.odd},
                     item->counters,
                     decode_provenance(row.tile, bytes)};
}

}  // namespace tessera::film
