// SPDX-License-Identifier: Apache-2.0
#include "server/store/job_store.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>
#include <utility>

#include "server/store/job_store_impl.hpp"
#include "server/store/log_damage.hpp"
#include "server/store/row_codec.hpp"

namespace tessera::store {

using core::ErrorCode;

namespace {

// The lock is released between batches.
constexpr int kBatchesAtOnce = 8;
constexpr std::int64_t kTilesPerBatch = 32;

}  // namespace

JobRow read_job(const Statement& row) {
  JobRow job;
  job.id = row.bytes(0);
  job.request_id = row.bytes(1);
  job.spec = row.bytes(2);
  job.revision = as_unsigned(row.integer(3));
  job.state = static_cast<int>(row.integer(4));
  job.failure = row.bytes(5);
  job.spp = static_cast<std::uint32_t>(row.integer(6));
  job.priority = static_cast<int>(row.integer(7));
  job.created_ms = row.integer(8);
  if (!row.is_null(9)) job.finished_ms = row.integer(9);
  job.counters = row.bytes(10);
  job.arithmetic = row.bytes(11);
  job.max_workers = static_cast<std::uint32_t>(row.integer(12));
  // Rows of the first release have no sum.
  job.intact = row.is_null(13) || as_unsigned(row.integer(13)) == row_checksum(job);
  return job;
}

JobStore::JobStore(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
JobStore::JobStore(JobStore&&) noexcept = default;
JobStore& JobStore::operator=(JobStore&&) noexcept = default;
JobStore::~JobStore() = default;

std::uint32_t JobStore::epoch() const {
  return impl_->epoch;
}

const std::optional<std::string>& JobStore::torn_end() const {
  return impl_->torn_end;
}

core::Status JobStore::continue_from(std::uint32_t epoch) {
  const std::lock_guard lock(impl_->mutex);
  return impl_->database.execute(
      fmt::format("UPDATE meta SET value = {} WHERE name = 'epoch' AND value < {}", epoch, epoch));
}

core::Status JobStore::truncate_wal() {
  const std::lock_guard lock(impl_->mutex);
  return impl_->database.truncate_wal();
}

core::Result<std::vector<std::string>> JobStore::structural_damage() {
  const std::lock_guard lock(impl_->mutex);
  auto damage = impl_->database.structural_damage();
  const auto log = look_at_log(log_of(impl_->file));
  if (!log) return core::fail(log.error());
  if (damage && log->damage) damage->push_back(*log->damage);
  return damage;
}

std::array<std::uint64_t, 2> JobStore::secret() const {
  return impl_->secret;
}

core::Status JobStore::insert_job(const JobRow& job) {
  const std::lock_guard lock(impl_->mutex);
  Statement& insert = impl_->insert_job;
  insert.bind_text(1, job.id).bind_blob(3, job.spec).bind(4, as_signed(job.revision)).bind(5, job.state);
  insert.bind_text(6, job.failure).bind(7, job.spp).bind(8, job.priority).bind(9, job.created_ms);
  job.request_id.empty() ? insert.bind_null(2) : insert.bind_text(2, job.request_id);
  job.finished_ms ? insert.bind(10, *job.finished_ms) : insert.bind_null(10);
  insert.bind_blob(11, job.counters).bind_text(12, job.arithmetic).bind(13, job.max_workers);
  insert.bind(14, as_signed(row_checksum(job)));
  auto inserted = insert.run();
  if (inserted) impl_->database.checkpoint_wal();
  return inserted;
}

core::Status JobStore::update_job(const JobRow& job) {
  const std::lock_guard lock(impl_->mutex);
  Statement& update = impl_->update_job;
  update.bind_text(1, job.id).bind(2, as_signed(job.revision)).bind(3, job.state).bind_text(4, job.failure);
  update.bind(5, job.spp).bind(6, job.priority);
  job.finished_ms ? update.bind(7, *job.finished_ms) : update.bind_null(7);
  update.bind_blob(8, job.counters).bind_text(9, job.arithmetic).bind(10, job.max_workers);
  update.bind(11, as_signed(row_checksum(job)));
  return update.run();
}

core::Status JobStore::delete_job(const std::string& id) {
  const std::lock_guard lock(impl_->mutex);
  const core::Status deleted = impl_->delete_job.bind_text(1, id).run();
  if (deleted) impl_->deleted_jobs.push_back(id);
  return deleted;
}

core::Status JobStore::remove_deleted_tiles() {
  for (int batch = 0; batch < kBatchesAtOnce; ++batch) {
    const std::lock_guard lock(impl_->mutex);
    if (impl_->deleted_jobs.empty()) return {};
    const std::string& job = impl_->deleted_jobs.back();
    if (auto deleted = impl_->delete_tiles.bind_text(1, job).bind(2, kTilesPerBatch).run(); !deleted)
      return deleted;
    const auto has_more = impl_->has_tiles.bind_text(1, job).step();
    impl_->has_tiles.reset();
    if (!has_more) return core::fail(has_more.error());
    if (!*has_more) impl_->deleted_jobs.pop_back();
    impl_->database.checkpoint_wal();
  }
  return {};
}

core::Result<std::vector<JobRow>> JobStore::jobs() {
  const std::lock_guard lock(impl_->mutex);
  std::vector<JobRow> rows;
  Statement& list = impl_->list_jobs;
  const auto read = for_each_row(list, [&] { rows.push_back(read_job(list)); });
  if (!read) return core::fail(read.error());
  return rows;
}

core::Status JobStore::expect_file() const {
  std::error_code error;
  if (std::filesystem::exists(impl_->file, error) || error) return {};
  return core::fail(ErrorCode::kDataLoss,
                    fmt::format("{} was removed while the coordinator runs, and nothing is stored any more: "
                                "download the images that are finished, then stop the coordinator and put "
                                "back a copy of the state folder",
                                impl_->file.string()));
}

core::Status JobStore::write_tiles(const std::vector<TileRow>& tiles) {
  const std::lock_guard lock(impl_->mutex);
  auto transaction = Transaction::begin(impl_->database);
  if (!transaction) return core::fail(transaction.error());
  for (const TileRow& tile : tiles) {
    const std::string done = encode_ranges(tile.done);
    Statement& write = impl_->write_tile;
    write.bind_text(1, tile.job_id).bind(2, tile.tile).bind_blob(3, done).bind_blob(4, tile.content);
    write.bind(5, as_signed(row_checksum(tile, done)));
    if (auto written = write.run(); !written) return written;
  }
  return transaction->commit();
}

core::Result<std::map<int, std::vector<core::SampleRange>>> JobStore::tiles_done(const std::string& job_id) {
  const std::lock_guard lock(impl_->mutex);
  std::map<int, std::vector<core::SampleRange>> tiles;
  Statement& list = impl_->tiles_done.bind_text(1, job_id);
  const auto read =
      for_each_row(list, [&] { tiles[static_cast<int>(list.integer(0))] = decode_ranges(list.bytes(1)); });
  if (!read) return core::fail(read.error());
  return tiles;
}

core::Result<std::optional<TileRow>> JobStore::tile(const std::string& job_id, int tile) {
  const std::lock_guard lock(impl_->mutex);
  Statement& read = impl_->read_tile.bind_text(1, job_id).bind(2, tile);
  const ResetAtEnd at_end(read);
  const auto row = read.step();
  if (!row) return core::fail(row.error());
  if (!*row) return std::optional<TileRow>();
  TileRow found{job_id, tile, decode_ranges(read.bytes(0)), std::string(read.bytes(1))};
  if (as_unsigned(read.integer(2)) == row_checksum(found, read.bytes(0)))
    return std::optional(std::move(found));
  return core::fail(ErrorCode::kDataLoss,
                    fmt::format("{}: tile {} of job {} is damaged", impl_->file.string(), tile, job_id));
}

}  // namespace tessera::store
