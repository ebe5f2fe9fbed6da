#include "server/coordinator/job_film.hpp"

#include <fmt/format.h>

#include <utility>

#include "proto/tile_codec.hpp"

namespace tessera::coordinator {

namespace {

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

}  // namespace

JobFilm::JobFilm(core::TileGrid grid) : film_(grid), counters_(static_cast<std::size_t>(grid.tile_count())) {}

void JobFilm::add(int tile, const core::FilmTile& samples) {
  film_.add(samples);
  counters_[static_cast<std::size_t>(tile)].add(samples.counters);
  total_.add(samples.counters);
  changed_.insert(tile);
}

void JobFilm::restore(int tile, TileContent content) {
  film_.restore(tile, std::move(content.sums));
  counters_[static_cast<std::size_t>(tile)] = content.counters;
  total_.add(content.counters);
}

TileContent JobFilm::copy(int tile) const {
  return {film_.tile(tile), counters_[static_cast<std::size_t>(tile)]};
}

// The content travels in the form of a rendered item. Which samples it holds stands in `done`; the item's own
// range only has as many.
store::TileRow encode_tile_row(const std::string& job_id, int tile, const core::PixelRect& rect,
                               std::vector<core::SampleRange> done, const TileContent& content) {
  core::FilmTile item;
  item.rect = rect;
  item.range = {0, count_samples(done).all};
  item.sums = content.sums.sums;
  item.odd_sums = content.sums.odd_sums;
  item.counters = content.counters;
  return {job_id, tile, std::move(done), proto::encode_tile(item).SerializeAsString()};
}

core::Result<TileContent> decode_tile_row(const store::TileRow& row, const core::PixelRect& rect) {
  const auto damaged = [&](const std::string& how) {
    return core::fail(core::ErrorCode::kDataLoss,
                      fmt::format("the stored tile {} of job {} is damaged ({})", row.tile, row.job_id, how));
  };
  v1::RenderedItem message;
  if (!message.ParseFromString(row.content)) return damaged("not a rendered item");
  auto item = proto::decode_tile(message);
  if (!item) return damaged(item.error().message);
  const SampleCount count = count_samples(row.done);
  if (item->rect != rect || item->range.count() != count.all) return damaged("of another rectangle or range");
  return TileContent{{std::move(item->sums), std::move(item->odd_sums), count.all, count.odd},
                     item->counters};
}

}  // namespace tessera::coordinator
