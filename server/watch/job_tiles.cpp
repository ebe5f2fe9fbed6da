// SPDX-License-Identifier: Apache-2.0
#include "server/watch/job_tiles.hpp"

#include <fmt/format.h>

#include <utility>

#include "proto/json.hpp"
#include "server/jobs/find_job.hpp"

namespace tessera::watch {

bool is_final(v1::JobState state) {
  return state == v1::JOB_STATE_DONE || state == v1::JOB_STATE_CANCELLED || state == v1::JOB_STATE_FAILED;
}

core::Result<std::shared_ptr<const JobLook>> JobTiles::look() {
  const core::MutexLock lock(mutex_);
  const events::Revision revision = farm_.events().counter().last();
  if (last_ && last_revision_ == revision) return last_;
  auto made = look_again();
  if (!made) return made;
  last_ = *made;
  last_revision_ = revision;
  return made;
}

core::Result<std::shared_ptr<const JobLook>> JobTiles::look_again() const {
  auto found = jobs::find_job(farm_, store_, job_id_);
  if (!found) return core::fail(found.error());
  auto look = std::make_shared<JobLook>();
  look->job = summarise(found->snapshot);
  *look->job.mutable_warnings() = found->snapshot.spec->warnings();
  look->shape = found->snapshot.view.shape;
  look->film = std::move(found->film);
  return std::shared_ptr<const JobLook>(std::move(look));
}

core::Result<std::vector<view::TileChange>> JobTiles::changes_since(const JobLook& look, view::Revision since,
                                                                    std::size_t most) const {
  const int first = of_job(look, 0), end = first + look.shape.grid().tiles_per_image();
  std::vector<view::TileChange> changes;
  if (look.film) {
    look.film->apply();
    for (const film::TileEvent& change : look.film->changes_since(since, most, static_cast<int>(image_)))
      changes.push_back({change.revision, change.tile - first});
    return changes;
  }
  const auto stored = store_.tile_changes(job_id_, since, most, first, end);
  if (!stored) return core::fail(stored.error());
  for (const store::TileChange& change : *stored) changes.push_back({change.revision, change.tile - first});
  return changes;
}

core::Result<view::TileAtRevision> JobTiles::read(const JobLook& look, const view::TileChange& change) const {
  view::TileAtRevision tile{{}, change.revision, farm::layers_of(look.job)};
  const int of_all = of_job(look, change.tile);
  auto sums = look.film ? films_.sums(look.job, *look.film, of_all, &tile.revision)
                        : films_.stored_sums(look.job, of_all);
  if (!sums) return core::fail(sums.error());
  tile.sums = std::move(*sums);
  return tile;
}

std::string JobTiles::id() const {
  return image_ == 0 ? job_id_ : fmt::format("{} image {}", job_id_, image_);
}

core::Result<view::JobHeader> JobTiles::header() {
  const auto now = look();
  if (!now) return core::fail(now.error());
  const core::MutexLock lock(mutex_);
  if (described_ != *now) {
    json_ = proto::to_line(proto::to_json((*now)->job));
    described_ = *now;
  }
  return view::JobHeader{json_, (*now)->job.revision()};
}

// A job that is being validated, or has ended before it was, has no image.
std::optional<core::TileGrid> JobTiles::grid() {
  const auto now = look();
  if (!now || (*now)->job.samples_total() == 0) return std::nullopt;
  return (*now)->shape.grid().of_image();
}

core::LayerSet JobTiles::layers() {
  const auto now = look();
  return now ? farm::layers_of((*now)->job) : core::LayerSet();
}

core::Result<std::vector<view::TileChange>> JobTiles::changes_since(view::Revision since, std::size_t most) {
  const auto now = look();
  if (!now) return core::fail(now.error());
  return changes_since(**now, since, most);
}

core::Result<view::TileAtRevision> JobTiles::read(const view::TileChange& change) {
  const auto now = look();
  if (!now) return core::fail(now.error());
  return read(**now, change);
}

bool JobTiles::is_over() {
  const auto now = look();
  return now && is_final((*now)->job.state());
}

}  // namespace tessera::watch
