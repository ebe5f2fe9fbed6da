// SPDX-License-Identifier: Apache-2.0
// Writes changes to the store.
//
// Job rows are copied first and written last: the store has a row that says DONE only if it has all samples
// of the job. The rows of tiles are independent of each other, so they are copied one by one and written in
// batches of bounded size.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "server/coordinator/state_lock.hpp"
#include "server/coordinator/stored_tile.hpp"

namespace tessera::coordinator {

core::Status Coordinator::checkpoint() {
  const std::lock_guard one_at_a_time(checkpoint_mutex_);
  const std::vector<store::JobRow> rows = changed_rows();
  const core::Status written = write(rows);
  if (written) note_stored(rows);
  // Also after a failure, e.g. on a full disk: users can fetch the image from memory.
  publish_completions(rows);
  return written;
}

core::Status Coordinator::write(const std::vector<store::JobRow>& rows) {
  if (auto there = state_.jobs.expect_file(); !there) return there;
  const std::vector<TileRef> tiles = changed_tiles();
  for (std::size_t begin = 0; begin < tiles.size(); begin += kTilesPerBatch) {
    const std::size_t count = std::min(kTilesPerBatch, tiles.size() - begin);
    if (auto written = write_tiles(std::span(tiles).subspan(begin, count)); !written) return written;
  }
  for (const store::JobRow& row : rows) {
    if (auto written = state_.jobs.update_job(row); !written) return written;
  }
  return {};
}

std::vector<store::JobRow> Coordinator::changed_rows() {
  const StateLock lock(*this);
  checkpoint_is_awaited_ = false;
  std::vector<store::JobRow> rows;
  for (const auto& [id, record] : jobs_) {
    if (record.revision == record.stored_revision) continue;
    rows.push_back(to_row(record, *scheduler_.job({id}, lock.now())));
  }
  return rows;
}

std::vector<Coordinator::TileRef> Coordinator::changed_tiles() {
  const StateLock lock(*this);
  std::vector<TileRef> tiles;
  for (const auto& [id, record] : jobs_) {
    if (!record.film) continue;
    for (const int tile : record.film->changed()) tiles.push_back({id, tile});
  }
  return tiles;
}

core::Status Coordinator::write_tiles(std::span<const TileRef> tiles) {
  const auto take_copy = [this](const TileRef& ref) -> std::optional<TileCopy> {
    const StateLock lock(*this);
    const JobRecord* record = find(ref.job_id);
    if (record == nullptr || !record->film) return std::nullopt;  // deleted meanwhile
    record->film->mark_clean(ref.tile);
    TileCopy copy{ref, grid_of(*record->spec).rect(ref.tile),
                  scheduler_.done({ref.job_id}, ref.tile).ranges(), record->film->copy(ref.tile)};
    copy.content.provenance = {fingerprinter_.check(), scheduler_.provenance({ref.job_id}, ref.tile)};
    return copy;
  };
  std::vector<store::TileRow> rows;
  for (const TileRef& ref : tiles) {  // one at a time: its sums stay in the CPU cache until they are encoded
    auto copy = take_copy(ref);
    if (!copy) continue;
    rows.push_back(encode_tile_row(ref.job_id, ref.tile, copy->rect, std::move(copy->done), copy->content));
  }
  auto written = state_.jobs.write_tiles(rows);
  if (written) return written;
  const StateLock lock(*this);
  for (const TileRef& ref : tiles) {
    const JobRecord* record = find(ref.job_id);
    if (record != nullptr && record->film) record->film->mark_changed(ref.tile);
  }
  return written;
}

void Coordinator::note_stored(const std::vector<store::JobRow>& rows) {
  const StateLock lock(*this);
  for (const store::JobRow& row : rows) {
    if (JobRecord* record = find(row.id)) record->stored_revision = row.revision;
  }
  for (auto& [id, record] : jobs_) {
    const bool stored =
        record.film && record.film->changed().empty() && record.revision == record.stored_revision;
    if (!stored || !is_finished(scheduler_.job({id}, lock.now())->state)) continue;
    record.stored_counters = record.film->counters();
    record.film.reset();
  }
}

void Coordinator::publish_completions(const std::vector<store::JobRow>& rows) {
  const StateLock lock(*this);
  for (const store::JobRow& row : rows) {
    JobRecord* record = find(row.id);
    if (record != nullptr && record->unpublished_completion &&
        *record->unpublished_completion <= row.revision)
      record->unpublished_completion.reset();
  }
}

}  // namespace tessera::coordinator
