// SPDX-License-Identifier: Apache-2.0
#include "server/film/tile_row.hpp"

#include <fmt/format.h>

#include <utility>

#include "core/film/layout.hpp"
#include "proto/convert.hpp"
#include "proto/tile_codec.hpp"
#include "proto/tile_planes.hpp"
#include "server/film/stored_counters.hpp"

namespace tessera::film {

namespace {

// The first byte of the content: a stored::v1::Tile follows.
constexpr char kMark = 'T';
// Of earlier releases: a RenderedItem of the protocol with its sums in planes. Without a mark: one as it was
// sent over the network then. The provenance follows in the same bytes.
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

core::Error damaged(const store::TileRow& row, const std::string& how) {
  return {core::ErrorCode::kDataLoss,
          fmt::format("the stored tile {} of job {} is damaged ({})", row.tile, row.job_id, how)};
}

// `rect` is the expected rectangle of the item.
core::Result<core::FilmTile> decode_item_in_planes(const v1::RenderedItem& message,
                                                   const core::PixelRect& rect) {
  const auto item = proto::from_proto(message.item());
  if (!item) return core::fail(item.error());
  auto planes = proto::decode_planes(message.sums_zstd(), core::rgb_layout().sums(rect.pixel_count()));
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

core::Result<TileContent> decode_of_earlier_release(const store::TileRow& row, const core::PixelRect& rect) {
  const bool in_planes = !row.content.empty() && row.content.front() == kPlanesMark;
  const std::string bytes = in_planes ? row.content.substr(1) : row.content;
  v1::RenderedItem message;
  if (!message.ParseFromString(bytes)) return core::fail(damaged(row, "not a rendered item"));
  auto item = in_planes ? decode_item_in_planes(message, rect) : proto::decode_tile(message);
  if (!item) return core::fail(damaged(row, item.error().message));
  const SampleCount count = count_samples(row.done);
  if (item->rect != rect || item->range.count() != count.all)
    return core::fail(damaged(row, "of another rectangle or range"));
  stored::v1::Provenance provenance;
  if (!provenance.ParseFromString(bytes)) provenance.Clear();
  return TileContent{{std::move(item->sums), std::move(item->odd_sums), count.all, count.odd, {}},
                     item->counters,
                     from_stored(row.tile, provenance)};
}

core::Result<proto::TilePlanes> decode_layout(const stored::v1::Tile& message, const core::FilmLayout& layout,
                                              const core::PixelRect& rect) {
  const std::size_t pixels = rect.pixel_count();
  auto fit = proto::check_plane_words(message.plane_words(), layout, pixels, message.samples());
  if (!fit) return core::fail(fit.error());
  auto planes = proto::decode_planes(message.planes_zstd(), layout.sums(pixels), message.plane_words());
  if (!planes) return planes;
  if (auto possible = core::check_planes(layout, planes->planes, rect, message.samples()); !possible)
    return core::fail(possible.error());
  return planes;
}

bool is_rect(const stored::v1::Rect& stored, const core::PixelRect& rect) {
  return stored.x0() == static_cast<std::uint32_t>(rect.x0) &&
         stored.y0() == static_cast<std::uint32_t>(rect.y0) &&
         stored.x1() == static_cast<std::uint32_t>(rect.x1) &&
         stored.y1() == static_cast<std::uint32_t>(rect.y1);
}

}  // namespace

// `done` says which samples the tile holds; the message only has their number.
store::TileRow encode_tile_row(const std::string& job_id, int tile, const core::PixelRect& rect,
                               std::vector<core::SampleRange> done, const TileContent& content) {
  stored::v1::Tile message;
  message.mutable_rect()->set_x0(static_cast<std::uint32_t>(rect.x0));
  message.mutable_rect()->set_y0(static_cast<std::uint32_t>(rect.y0));
  message.mutable_rect()->set_x1(static_cast<std::uint32_t>(rect.x1));
  message.mutable_rect()->set_y1(static_cast<std::uint32_t>(rect.y1));
  message.set_samples(count_samples(done).all);
  *message.mutable_counters() = to_stored(content.counters);
  *message.mutable_provenance() = to_stored(content.provenance);
  proto::add_plane_words(content.sums.planes, *message.mutable_plane_words());
  message.set_planes_zstd(
      proto::encode_planes(content.sums.sums, content.sums.odd_sums, content.sums.planes));
  std::string bytes(1, kMark);
  message.AppendToString(&bytes);
  return {job_id, tile, std::move(done), std::move(bytes)};
}

core::Result<TileContent> decode_tile_row(const store::TileRow& row, const core::PixelRect& rect,
                                          core::LayerSet layers) {
  if (row.done.empty()) return TileContent{};  // all samples were removed again
  const bool is_of_earlier_release = row.content.empty() || row.content.front() != kMark;
  if (is_of_earlier_release && !layers.empty()) return core::fail(damaged(row, "without layers"));
  if (is_of_earlier_release) return decode_of_earlier_release(row, rect);
  stored::v1::Tile message;
  if (!message.ParseFromArray(row.content.data() + 1, static_cast<int>(row.content.size() - 1)))
    return core::fail(damaged(row, "not a tile"));
  const SampleCount count = count_samples(row.done);
  if (!is_rect(message.rect(), rect) || message.samples() != count.all)
    return core::fail(damaged(row, "of another rectangle or range"));
  auto planes = decode_layout(message, core::film_layout(layers), rect);
  if (!planes) return core::fail(damaged(row, planes.error().message));
  TileContent content{
      {std::move(planes->sums), std::move(planes->odd_sums), count.all, count.odd, std::move(planes->planes)},
      from_stored(message.counters()),
      from_stored(row.tile, message.provenance())};
  if (content.counters.samples != rect.pixel_count() * std::uint64_t{count.all})
    return core::fail(damaged(row, "its counters are of other samples"));
  return content;
}

}  // namespace tessera::film
