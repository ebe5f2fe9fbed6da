// SPDX-License-Identifier: Apache-2.0
#include "server/watch/tile_feed.hpp"

#include "core/film/develop.hpp"
#include "proto/convert.hpp"
#include "server/jobs/image_choice.hpp"

namespace tessera::watch {

namespace {

constexpr std::size_t kChangesAtOnce = 64;

bool touches(const core::PixelRect& a, const core::PixelRect& b) {
  return a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1;
}

std::optional<view::PixelFormat> pixel_format(v1::TileFormat format) {
  if (format == v1::TILE_FORMAT_RGB16F) return view::PixelFormat::kHalf;
  if (format == v1::TILE_FORMAT_RGB32F || format == v1::TILE_FORMAT_ALL32F) return view::PixelFormat::kFloat;
  return std::nullopt;
}

// A job that is being validated, or has ended before it was, has no image.
bool has_image(const v1::Job& job) {
  return job.samples_total() > 0;
}

core::Status check_format(const TileQuery& query) {
  if (!pixel_format(query.format))
    return core::fail(core::ErrorCode::kInvalidArgument, "format: must be one of TileFormat");
  if (query.format == v1::TILE_FORMAT_ALL32F && query.layer)
    return core::fail(core::ErrorCode::kInvalidArgument,
                      "layer: must be empty with TILE_FORMAT_ALL32F, which has all layers");
  return {};
}

core::Status check_region(const TileQuery& query, const core::PixelRect& window) {
  if (query.region && (query.region->empty() || !window.contains(*query.region)))
    return core::fail(core::ErrorCode::kInvalidArgument,
                      "region: must be pixels of the job, and must not be empty");
  return {};
}

}  // namespace

core::Result<std::shared_ptr<const view::EncodedTile>> TileFeed::encoded(const TileQuery& query,
                                                                         const JobTiles& source,
                                                                         const JobLook& look,
                                                                         const view::TileChange& change) {
  return images_.get({.job_id = source.id(),
                      .tile = change.tile,
                      .format = *pixel_format(query.format),
                      .layer = query.layer,
                      .has_all_channels = query.format == v1::TILE_FORMAT_ALL32F},
                     change.revision, look.shape.grid().rect(change.tile),
                     [&] { return source.read(look, change); });
}

core::Result<TileUpdate> TileFeed::update(const TileQuery& query) {
  JobTiles source(farm_, films_, store_, query.job_id, query.image);
  const auto now = source.look();
  if (!now) return core::fail(now.error());
  const JobLook& look = **now;
  if (auto valid = check_format(query); !valid) return core::fail(valid.error());
  if (!has_image(look.job)) return TileUpdate{look.job, {}, query.since, true};
  if (auto there = jobs::check_image(look.shape, query.image); !there) return core::fail(there.error());
  if (auto there = view::check_layer(farm::layers_of(look.job), query.layer); !there)
    return core::fail(there.error());
  const core::TileGrid grid = look.shape.grid().of_image();
  if (auto valid = check_region(query, grid.window()); !valid) return core::fail(valid.error());
  TileUpdate update{look.job, {}, query.since, false};
  if (query.format == v1::TILE_FORMAT_ALL32F)
    update.channels = core::image_channels(farm::layers_of(look.job));
  for (std::size_t bytes = 0; bytes < query.max_bytes || bytes == 0;) {
    const auto next = source.changes_since(look, update.revision, kChangesAtOnce);
    if (!next) return core::fail(next.error());
    for (const view::TileChange& change : *next) {
      update.revision = change.revision;
      const core::PixelRect rect = grid.rect(change.tile);
      if (query.region && !touches(rect, *query.region)) continue;
      const auto tile = encoded(query, source, look, change);
      if (!tile) return core::fail(tile.error());
      v1::TileImage& added = update.tiles.emplace_back();
      *added.mutable_rect() = proto::to_proto(rect);
      added.set_samples((*tile)->samples);
      added.set_samples_target(source.target(look, change.tile));
      added.set_image(query.image);
      added.set_pixels_zlib((*tile)->pixels);
      bytes += (*tile)->pixels.size();
      if (bytes >= query.max_bytes) return update;
    }
    update.is_current = next->size() < kChangesAtOnce;
    if (update.is_current) return update;
  }
  return update;
}

}  // namespace tessera::watch
