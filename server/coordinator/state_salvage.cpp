#include <fmt/format.h>

#include <system_error>
#include <utility>
#include <vector>

#include "server/coordinator/job_record.hpp"
#include "server/coordinator/state_check.hpp"
#include "server/coordinator/stored_tile.hpp"
#include "server/store/log_damage.hpp"
#include "server/store/state_directory.hpp"

namespace tessera::coordinator {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kTilesPerBatch = 64;
constexpr const char* kCopyName = "tessera.db.salvaged";

core::Status keep_tiles(store::JobStore& from, store::JobStore& to, const store::JobRow& row,
                        const core::TileGrid& grid, Salvage& salvage) {
  std::vector<store::TileRow> batch;
  // Not those that are listed: the list may be what is damaged.
  for (int tile = 0; tile < grid.tile_count(); ++tile) {
    auto stored = read_stored_tile(from, row.id, grid, tile);
    if (stored) {
      ++salvage.tiles;
      batch.push_back(std::move(stored->row));
    } else if (stored.error().code != core::ErrorCode::kNotFound) {
      ++salvage.lost_tiles;
    }
    if (batch.size() < kTilesPerBatch && tile + 1 < grid.tile_count()) continue;
    if (auto written = to.write_tiles(batch); !written) return written;
    batch.clear();
  }
  return {};
}

// Of the old database: what SQLite cannot make sense of is damage, too.
core::Error beyond_reading(const fs::path& database, const core::Error& error) {
  if (error.code != core::ErrorCode::kDataLoss && error.code != core::ErrorCode::kInternal) return error;
  return {core::ErrorCode::kDataLoss,
          fmt::format(
              "{} is damaged beyond reading: put back a copy of the state folder, or move the folder away to "
              "start without its jobs",
              database.string())};
}

core::Result<Salvage> copy_whole_jobs(const fs::path& database, store::JobStore& from, store::JobStore& to) {
  const auto rows = from.jobs();
  if (!rows) return core::fail(beyond_reading(database, rows.error()));
  Salvage salvage;
  for (const store::JobRow& row : *rows) {
    const auto record = from_row(row);
    ++(record ? salvage.jobs : salvage.lost_jobs);
    if (!record) continue;
    if (auto kept = to.insert_job(row); !kept) return core::fail(kept.error());
    auto kept = keep_tiles(from, to, row, grid_of(*record->spec), salvage);
    if (!kept) return core::fail(kept.error());
  }
  if (auto later = to.continue_from(from.epoch()); !later) return core::fail(later.error());
  return salvage;
}

// A database is its file and what SQLite keeps beside it.
void remove_database(const fs::path& file) {
  for (const char* ending : {"", "-wal", "-shm"}) {
    std::error_code ignored;  // what is in the way shows when it is opened
    fs::remove(file.string() + ending, ignored);
  }
}

fs::path free_name(const fs::path& database) {
  for (int number = 1;; ++number) {
    const fs::path name = fmt::format("{}.damaged-{}", database.string(), number);
    if (!fs::exists(name)) return name;
  }
}

core::Status move(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::rename(from, to, error);
  if (!error) return {};
  return core::fail(core::ErrorCode::kInternal,
                    fmt::format("renaming {} to {}: {}", from.string(), to.string(), error.message()));
}

// The log goes first: left behind, it would be taken for the new database's.
core::Status set_aside(const fs::path& database, const fs::path& name) {
  if (fs::exists(store::log_of(database))) {
    if (auto moved = move(store::log_of(database), store::log_of(name)); !moved) return moved;
  }
  std::error_code ignored;  // SQLite makes it anew
  fs::remove(database.string() + "-shm", ignored);
  return move(database, name);
}

}  // namespace

core::Result<Salvage> salvage_state(const fs::path& folder) {
  const auto lock = store::lock_existing_state(folder);
  if (!lock) return core::fail(lock.error());
  const fs::path database = folder / store::kDatabaseName, copy = folder / kCopyName;
  remove_database(copy);
  core::Result<Salvage> salvage;
  {
    auto from = store::JobStore::open_untouched(database);
    if (!from) return core::fail(beyond_reading(database, from.error()));
    auto to = store::JobStore::open(copy);
    if (!to) return core::fail(to.error());
    salvage = copy_whole_jobs(database, *from, *to);
  }  // closing the copy folds its log into it
  if (!salvage) {
    remove_database(copy);
    return salvage;
  }
  salvage->set_aside = free_name(database);
  if (auto moved = set_aside(database, salvage->set_aside); !moved) return core::fail(moved.error());
  if (auto moved = move(copy, database); !moved) return core::fail(moved.error());
  if (auto safe = store::sync_folder(folder); !safe) return core::fail(safe.error());
  return salvage;
}

}  // namespace tessera::coordinator
