// SPDX-License-Identifier: Apache-2.0
// The job store as a whole, and what it writes.
#include "server/store/job_store.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <stop_token>
#include <system_error>
#include <utility>

#include "server/store/job_store_impl.hpp"
#include "server/store/log_damage.hpp"
#include "server/store/row_codec.hpp"

namespace tessera::store {

using core::ErrorCode;

namespace {

constexpr int kBatchesAtOnce = 8;
constexpr std::int64_t kTilesPerBatch = 32;
// Free pages that are kept for tiles to come, and how many of the others are given back at once: to give one
// back, another page is moved there.
constexpr std::int64_t kSparePages = 256, kPagesAtOnce = 256;

void bind_mutable(Statement& update, const JobRow& job, std::optional<std::uint64_t> bundle_sum) {
  update.bind_text(1, job.id).bind(2, as_signed(job.revision)).bind(3, job.state).bind_text(4, job.failure);
  update.bind(5, job.spp).bind(6, job.priority);
  job.finished_ms ? update.bind(7, *job.finished_ms) : update.bind_null(7);
  update.bind_blob(8, job.counters).bind_text(9, job.arithmetic).bind(10, job.max_workers);
  update.bind(11, as_signed(row_checksum(job, bundle_sum)));
  update.bind_blob(12, job.producers).bind(13, job.settled ? 1 : 0).bind_blob(14, job.failure_details);
  // The spec hardly changes, but the checksum is that of these bytes, and a message has several encodings.
  update.bind_blob(15, job.targets).bind_blob(16, job.spec);
}

void bind_validated(Statement& statement, const JobRow& job, std::optional<std::uint64_t> bundle_sum) {
  statement.bind_blob(17, job.submission).bind_blob(19, job.bundle);
  bundle_sum ? statement.bind(20, as_signed(*bundle_sum)) : statement.bind_null(20);
}

void bind_all(Statement& statement, const JobRow& job) {
  const auto bundle_sum = bundle_checksum(job.bundle);
  bind_mutable(statement, job, bundle_sum);
  bind_validated(statement, job, bundle_sum);
  statement.bind_text(18, job.owner);
}

}  // namespace

JobStore::JobStore(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
JobStore::JobStore(JobStore&&) noexcept = default;
JobStore& JobStore::operator=(JobStore&&) noexcept = default;
JobStore::~JobStore() = default;

std::uint32_t JobStore::epoch() const {
  return impl_->epoch;
}

const std::filesystem::path& JobStore::file() const {
  return impl_->file;
}

const std::optional<std::string>& JobStore::torn_end() const {
  return impl_->torn_end;
}

std::array<std::uint64_t, 2> JobStore::secret() const {
  return impl_->secret;
}

std::uint64_t JobStore::transactions() const {
  return impl_->commits.groups();
}

bool JobStore::has_rest_to_check() const {
  return impl_->has_rest_to_check;
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

core::Status JobStore::continue_from(std::uint32_t epoch) {
  return impl_->write([&] {
    return impl_->writer->database.execute(
        fmt::format("UPDATE meta SET value = {} WHERE name = 'epoch' AND value < {}", epoch, epoch));
  });
}

core::Status JobStore::truncate_wal() {
  return impl_->commits.run_alone([&] { return impl_->writer->database.truncate_wal(); });
}

core::Result<std::vector<std::string>> JobStore::structural_damage() {
  const core::MutexLock lock(impl_->reading);
  auto damage = impl_->reader.database.structural_damage();
  const auto log = look_at_log(log_of(impl_->file));
  if (!log) return core::fail(log.error());
  if (damage && log->damage) damage->push_back(*log->damage);
  return damage;
}

core::Status JobStore::check_rest(const std::stop_token& stop) {
  auto database = Database::open_reader(impl_->file);
  if (!database) return core::fail(database.error());
  const std::stop_callback on_stop(stop, [&] { database->interrupt(); });
  const auto found = database->structural_damage();
  if (stop.stop_requested()) return core::fail(ErrorCode::kCancelled, "the check was stopped");
  if (!found) return core::fail(found.error());
  if (found->empty()) return {};
  const core::MutexLock lock(impl_->mutex);
  impl_->damage = damaged(impl_->file, found->front());
  return core::fail(*impl_->damage);
}

core::Status JobStore::Impl::write(const std::function<core::Status()>& change) {
  {
    const core::MutexLock lock(mutex);
    if (damage) return core::fail(*damage);
  }
  if (!writer)
    return core::fail(ErrorCode::kFailedPrecondition,
                      "the database is only looked at: nothing is written to it");
  return commits.run(change);
}

// A change that fails is undone alone, unless the error has ended the transaction.
void JobStore::Impl::apply(std::span<PendingChange* const> group) {
  Database& database = writer->database;
  const auto fail_all = [&](const core::Error& error) {
    for (PendingChange* each : group)
      if (each->status) each->status = core::fail(error);
  };
  auto transaction = Transaction::begin(database);
  if (!transaction) return fail_all(transaction.error());
  for (PendingChange* each : group) {
    const bool is_alone = group.size() == 1;
    if (!is_alone) each->status = database.execute("SAVEPOINT change");
    if (each->status) each->status = each->change();
    if (each->status && !is_alone) each->status = database.execute("RELEASE change");
    if (each->status) continue;
    if (is_alone) return;
    if (!database.is_in_transaction()) return fail_all(each->status.error());
    if (auto undone = database.execute("ROLLBACK TO change; RELEASE change"); !undone)
      return fail_all(undone.error());
  }
  if (const auto committed = transaction->commit(); !committed) return fail_all(committed.error());
  if (wants_checkpoint.exchange(false)) database.checkpoint_wal();
}

core::Status JobStore::insert_job(const JobRow& job) {
  if (auto there = expect_file(); !there) return there;
  return impl_->write([&] {
    Statement& insert = impl_->writer->insert_job;
    bind_all(insert, job);
    job.request_id.empty() ? insert.bind_null(21) : insert.bind_text(21, job.request_id);
    insert.bind(22, job.created_ms);
    impl_->wants_checkpoint = true;
    return insert.run();
  });
}

core::Result<bool> Writer::run_update(Statement& update, const JobRow& job) {
  if (auto updated = update.run(); !updated) return core::fail(updated.error());
  if (!database.has_changed()) return false;
  set_indexed.bind_text(1, job.id).bind(2, job.state).bind(4, job.settled ? 1 : 0);
  job.finished_ms ? set_indexed.bind(3, *job.finished_ms) : set_indexed.bind_null(3);
  if (auto set = set_indexed.run(); !set) return core::fail(set.error());
  return true;
}

core::Status JobStore::update_job(const JobRow& job) {
  return impl_->write([&]() -> core::Status {
    Statement& update = impl_->writer->update_job;
    bind_mutable(update, job, bundle_checksum(job.bundle));
    const auto updated = impl_->writer->run_update(update, job);
    return updated ? core::Status() : core::fail(updated.error());
  });
}

core::Status JobStore::end_validation(const JobRow& job) {
  return impl_->write([&]() -> core::Status {
    Statement& update = impl_->writer->end_validation;
    const auto bundle_sum = bundle_checksum(job.bundle);
    bind_mutable(update, job, bundle_sum);
    bind_validated(update, job, bundle_sum);
    const auto updated = impl_->writer->run_update(update, job);
    return updated ? core::Status() : core::fail(updated.error());
  });
}

core::Result<bool> JobStore::replace_job(const JobRow& job, std::uint64_t revision) {
  core::Result<bool> is_replaced = false;
  const core::Status written = impl_->write([&]() -> core::Status {
    Statement& replace = impl_->writer->replace_job;
    bind_all(replace, job);
    replace.bind(21, as_signed(revision));
    is_replaced = impl_->writer->run_update(replace, job);
    return is_replaced ? core::Status() : core::fail(is_replaced.error());
  });
  if (!written) return core::fail(written.error());
  return is_replaced;
}

core::Status JobStore::rewrite_jobs(const std::vector<JobRow>& jobs) {
  return impl_->write([&]() -> core::Status {
    Statement& replace = impl_->writer->replace_job;
    for (const JobRow& job : jobs) {
      bind_all(replace, job);
      replace.bind(21, as_signed(job.revision));
      if (auto replaced = impl_->writer->run_update(replace, job); !replaced)
        return core::fail(replaced.error());
    }
    return {};
  });
}

core::Status JobStore::settle_jobs(const std::vector<JobRow>& jobs) {
  return impl_->write([&]() -> core::Status {
    Statement& settle = impl_->writer->settle_job;
    for (const JobRow& job : jobs) {
      bind_mutable(settle, job, bundle_checksum(job.bundle));
      if (auto settled = impl_->writer->run_update(settle, job); !settled) return core::fail(settled.error());
    }
    return {};
  });
}

core::Status JobStore::delete_jobs(const std::vector<std::string>& ids) {
  const core::Status deleted = impl_->write([&]() -> core::Status {
    for (const std::string& id : ids) {
      if (auto noted = impl_->writer->note_deleted.bind_text(1, id).run(); !noted) return noted;
      if (auto gone = impl_->writer->delete_job.bind_text(1, id).run(); !gone) return gone;
    }
    return {};
  });
  if (!deleted) return deleted;
  const core::MutexLock lock(impl_->mutex);
  impl_->deleted_jobs.insert(impl_->deleted_jobs.end(), ids.begin(), ids.end());
  return {};
}

core::Status JobStore::remove_deleted_tiles() {
  for (int batch = 0; batch < kBatchesAtOnce; ++batch) {
    std::string job;
    {
      const core::MutexLock lock(impl_->mutex);
      if (impl_->deleted_jobs.empty()) break;
      job = impl_->deleted_jobs.back();
    }
    if (auto removed = impl_->remove_tiles_of(job); !removed) return removed;
    if (batch + 1 == kBatchesAtOnce) return {};
  }
  return impl_->give_back_free_pages();
}

core::Status JobStore::Impl::remove_tiles_of(const std::string& job) {
  bool has_more = true;
  const core::Status removed = write([&]() -> core::Status {
    if (auto deleted = writer->delete_tiles.bind_text(1, job).bind(2, kTilesPerBatch).run(); !deleted)
      return deleted;
    wants_checkpoint = true;
    const auto found = writer->has_tiles.bind_text(1, job).step();
    writer->has_tiles.reset();
    if (!found) return core::fail(found.error());
    has_more = *found;
    return has_more ? core::Status() : writer->forget_deleted.bind_text(1, job).run();
  });
  if (!removed) return removed;
  const core::MutexLock lock(mutex);
  if (!has_more) std::erase(deleted_jobs, job);
  return {};
}

core::Status JobStore::Impl::give_back_free_pages() {
  {
    const core::MutexLock lock(reading);
    const auto free = reader.database.read_number("PRAGMA freelist_count");
    if (!free) return core::fail(free.error());
    if (*free <= kSparePages) return {};
  }
  return write([&] {
    wants_checkpoint = true;
    return writer->database.execute(fmt::format("PRAGMA incremental_vacuum({})", kPagesAtOnce));
  });
}

core::Status JobStore::write_tiles(const std::vector<TileRow>& tiles) {
  return impl_->write([&]() -> core::Status {
    for (const TileRow& tile : tiles) {
      const std::string done = encode_ranges(tile.done);
      Statement& write = impl_->writer->write_tile;
      write.bind_text(1, tile.job_id).bind(2, tile.tile).bind_blob(3, done).bind_blob(4, tile.content);
      write.bind(5, as_signed(row_checksum(tile, done)));
      if (auto written = write.run(); !written) return written;
      const std::uint64_t revision =
          tile.revision == 0 ? static_cast<std::uint64_t>(tile.tile) + 1 : tile.revision;
      Statement& note = impl_->writer->write_revision;
      note.bind_text(1, tile.job_id).bind(2, tile.tile).bind(3, as_signed(revision));
      if (auto noted = note.run(); !noted) return noted;
    }
    return {};
  });
}

}  // namespace tessera::store
