// SPDX-License-Identifier: Apache-2.0
#include "server/watch/tile_feed.hpp"

#include <utility>

#include "proto/convert.hpp"
#include "server/farm/state_lock.hpp"
#include "server/watch/tile_pixels.hpp"

namespace tessera::watch {

namespace {

constexpr std::size_t kChangesAtOnce = 64;

bool touches(const core::PixelRect& a, const core::PixelRect& b) {
  return a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1;
}

// A job that is being validated, or has ended before it was, has no image.
bool has_image(const v1::Job& job) {
  return job.samples_total() > 0;
}

core::Status check_region(const TileQuery& query, const core::PixelRect& window) {
  if (query.region && (query.region->empty() || !window.contains(*query.region)))
    return core::fail(core::ErrorCode::kInvalidArgument,
                      "region: must be pixels of the job, and must not be empty");
  return {};
}

}  // namespace

std::shared_ptr<film::JobFilm> TileFeed::film_of(const std::string& job_id) {
  const farm::StateLock lock(farm_);
  const farm::JobRecord* const record = lock->find_job(job_id);
  return record == nullptr ? nullptr : record->film;
}

core::Result<std::vector<film::TileEvent>> TileFeed::changes(const TileQuery& query,
                                                             const film::JobFilm* film,
                                                             events::Revision since) {
  if (film != nullptr) return film->changes_since(since, kChangesAtOnce);
  const auto stored = store_.tile_changes(query.job_id, since, kChangesAtOnce);
  if (!stored) return core::fail(stored.error());
  std::vector<film::TileEvent> changes;
  for (const store::TileChange& change : *stored) changes.push_back({change.revision, change.tile});
  return changes;
}

core::Result<std::shared_ptr<const EncodedTile>> TileFeed::encoded(const TileQuery& query, const v1::Job& job,
                                                                   const std::shared_ptr<film::JobFilm>& film,
                                                                   const film::TileEvent& change) {
  const auto read = [&]() -> core::Result<TileAtRevision> {
    TileAtRevision tile{{}, change.revision};
    auto sums =
        film ? films_.sums(job, *film, change.tile, &tile.revision) : films_.stored_sums(job, change.tile);
    if (!sums) return core::fail(sums.error());
    tile.sums = std::move(*sums);
    return tile;
  };
  return images_.get({query.job_id, change.tile, query.format}, change.revision,
                     farm::grid_of(job).rect(change.tile), read);
}

// The job is read before its tiles: those of a done job are then complete.
core::Result<TileUpdate> TileFeed::update(const TileQuery& query) {
  auto job = jobs_.get_without_bundle(query.job_id);
  if (!job) return core::fail(job.error());
  if (!is_known(query.format))
    return core::fail(core::ErrorCode::kInvalidArgument, "format: must be one of TileFormat");
  if (!has_image(*job)) return TileUpdate{std::move(*job), {}, query.since, true};
  const core::TileGrid grid = farm::grid_of(*job);
  if (auto valid = check_region(query, grid.window()); !valid) return core::fail(valid.error());
  const std::shared_ptr<film::JobFilm> film = film_of(query.job_id);
  if (film) film->apply();
  TileUpdate update{std::move(*job), {}, query.since, false};
  for (std::size_t bytes = 0; bytes < query.max_bytes || bytes == 0;) {
    const auto next = changes(query, film.get(), update.revision);
    if (!next) return core::fail(next.error());
    for (const film::TileEvent& change : *next) {
      update.revision = change.revision;
      if (change.tile < 0 || change.tile >= grid.tile_count()) continue;
      const core::PixelRect rect = grid.rect(change.tile);
      if (query.region && !touches(rect, *query.region)) continue;
      const auto tile = encoded(query, update.job, film, change);
      if (!tile) return core::fail(tile.error());
      v1::TileImage& added = update.tiles.emplace_back();
      *added.mutable_rect() = proto::to_proto(rect);
      added.set_samples((*tile)->samples);
      added.set_samples_target(update.job.settings().spp());
      added.set_pixels_zlib((*tile)->pixels_zlib);
      bytes += (*tile)->pixels_zlib.size();
      if (bytes >= query.max_bytes) return update;
    }
    update.is_current = next->size() < kChangesAtOnce;
    if (update.is_current) return update;
  }
  return update;
}

}  // namespace tessera::watch
