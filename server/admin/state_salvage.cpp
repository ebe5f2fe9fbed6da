// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <chrono>
#include <ratio>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "server/admin/database_copy.hpp"
#include "server/admin/state_check.hpp"
#include "server/farm/job_record.hpp"
#include "server/farm/validating_job.hpp"
#include "server/film/stored_tile.hpp"
#include "server/store/replacement.hpp"
#include "server/store/state_directory.hpp"

namespace tessera::admin {

namespace {

namespace fs = std::filesystem;

constexpr const char* kCopyName = "tessera.db.salvaged";

core::Status keep_tiles(store::JobStore& from, store::JobStore& to, const store::JobRow& row,
                        const v1::Job& job, Salvage& salvage) {
  const scheduler::JobGrid grid = farm::grid_of(job);
  const core::LayerSet layers = farm::layers_of(job);
  const bool is_rendered_on = row.state != v1::JOB_STATE_CANCELLED && row.state != v1::JOB_STATE_FAILED;
  std::vector<store::TileRow> batch;
  std::size_t batch_bytes = 0;
  // Tries every tile, since the list of tiles may be damaged.
  for (int tile = 0; tile < grid.tile_count(); ++tile) {
    auto stored = film::read_stored_tile(from, row.id, grid, tile, layers);
    if (stored) {
      ++salvage.tiles;
      batch_bytes += stored->row.content.size();
      batch.push_back(std::move(stored->row));
    } else if (stored.error().code != core::ErrorCode::kNotFound) {
      ++(is_rendered_on ? salvage.lost_tiles : salvage.tiles_lost_for_good);
    }
    const bool is_full = batch.size() == film::kTilesPerBatch || batch_bytes >= film::kBytesPerBatch;
    if (!is_full && tile + 1 < grid.tile_count()) continue;
    if (auto written = to.write_tiles(batch); !written) return written;
    batch.clear();
    batch_bytes = 0;
  }
  return {};
}

// The error for an old database that cannot be read. An internal error of SQLite is damage, too.
core::Error beyond_reading(const fs::path& database, const core::Error& error) {
  if (error.code != core::ErrorCode::kDataLoss && error.code != core::ErrorCode::kInternal) return error;
  return {core::ErrorCode::kDataLoss,
          fmt::format(
              "{} is damaged beyond reading: put back a copy of the state folder, or move the folder away to "
              "start without its jobs",
              database.string())};
}

// An epoch beyond all earlier ones: no coordinator was started more often than every quarter of an hour since
// 1970, and 24 bits last for some centuries of that.
std::uint32_t epoch_beyond_all() {
  using QuarterHours = std::chrono::duration<std::uint32_t, std::ratio<900>>;
  return std::chrono::duration_cast<QuarterHours>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

// As far as they can be read: what is lost is found again by audits.
core::Status copy_quarantine(store::JobStore& from, store::JobStore& to) {
  const auto rows = from.quarantine();
  if (!rows) return {};
  for (const store::QuarantineRow& row : *rows) {
    if (!row.intact) continue;
    if (auto kept = to.write_quarantine(row.id, row.content); !kept) return kept;
  }
  return {};
}

// Damage can duplicate rows, and give two jobs the same request_id.
core::Result<Salvage> copy_whole_jobs(const fs::path& database, store::JobStore& from, store::JobStore& to) {
  auto readable = from.readable_jobs();
  if (!readable) return core::fail(beyond_reading(database, readable.error()));
  Salvage salvage;
  salvage.lost_jobs = readable->unreadable;
  std::set<std::string> kept_ids, kept_requests;
  for (store::JobRow& row : readable->rows) {
    const auto job = farm::spec_from_row(row);
    if (job && !kept_ids.insert(row.id).second) continue;
    ++(job ? salvage.jobs : salvage.lost_jobs);
    if (!job) continue;
    if (!row.request_id.empty() && !kept_requests.insert(row.request_id).second) row.request_id.clear();
    row.settled = false;  // the next start looks for lost tiles
    if (auto kept = to.insert_job(row); !kept) return core::fail(kept.error());
    auto kept = keep_tiles(from, to, row, **job, salvage);
    if (!kept) return core::fail(kept.error());
  }
  if (auto kept = copy_quarantine(from, to); !kept) return core::fail(kept.error());
  const std::uint32_t epoch = from.epoch() > 0 ? from.epoch() : epoch_beyond_all();
  if (auto later = to.continue_from(epoch); !later) return core::fail(later.error());
  if (auto whole = to.truncate_wal(); !whole) return core::fail(whole.error());
  return salvage;
}

// A copy of an interrupted salvage is removed only after the old database could be opened.
core::Result<Salvage> make_copy(const fs::path& database, const fs::path& copy) {
  auto from = store::JobStore::open_read_only(database);
  if (!from) return core::fail(beyond_reading(database, from.error()));
  remove_database(copy);
  core::Result<Salvage> salvage;
  {
    auto to = store::JobStore::open(copy);
    if (!to) return core::fail(to.error());
    salvage = copy_whole_jobs(database, *from, *to);
  }
  if (auto whole = expect_empty_log(copy); salvage && !whole) salvage = core::fail(whole.error());
  if (!salvage) remove_database(copy);
  return salvage;
}

}  // namespace

core::Result<Salvage> salvage_state(const fs::path& folder) {
  const auto lock = store::lock_state_to_mend(folder);
  if (!lock) return core::fail(lock.error());
  const fs::path database = folder / store::kDatabaseName, copy = folder / kCopyName;
  if (auto undone = store::undo_interrupted_replacement(database); !undone) return core::fail(undone.error());
  auto salvage = make_copy(database, copy);
  if (!salvage) return salvage;
  auto set_aside = store::replace_database(database, copy);
  remove_database(copy);  // does nothing if it was put in place
  if (!set_aside) return core::fail(set_aside.error());
  salvage->set_aside = *std::move(set_aside);
  return salvage;
}

}  // namespace tessera::admin
