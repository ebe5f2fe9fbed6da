// SPDX-License-Identifier: Apache-2.0
#include "server/jobs/checkpointer.hpp"

#include <map>
#include <new>
#include <optional>
#include <utility>

#include "core/common/log.hpp"
#include "server/farm/state_lock.hpp"
#include "server/farm/steps.hpp"

namespace tessera::jobs {

using core::ErrorCode;
using farm::JobRecord;
using farm::StateLock;

namespace {

// How many jobs are looked at under one hold of the state lock, or of the event log's.
constexpr std::size_t kJobsAtOnce = 64;

// Calls look(first, last) for each part of the ids.
template <typename Look>
void in_parts(const std::set<std::string>& ids, Look look) {
  for (auto first = ids.begin(); first != ids.end();) {
    auto last = first;
    for (std::size_t i = 0; i < kJobsAtOnce && last != ids.end(); ++i) ++last;
    look(first, last);
    first = last;
  }
}

std::set<std::string> ids_of_jobs(farm::Farm& farm) {
  std::set<std::string> ids;
  farm::visit_in_steps(farm, &farm::State::jobs,
                       [&](const StateLock&, const std::string& id, const JobRecord&) { ids.insert(id); });
  return ids;
}

}  // namespace

core::Status Checkpointer::checkpoint() {
  const core::MutexLock one_at_a_time(mutex_);
  const auto begin = CheckpointStats::Clock::now();
  core::Status written = checkpoint_now();
  stats_.note(begin, written.has_value());
  return written;
}

core::Status Checkpointer::checkpoint_now() try {
  held_back_.clear();
  unreadable_ = {};
  read_events();
  const std::vector<farm::JobSnapshot> changed = changed_jobs();
  const core::Status written = write(changed);
  film_memory_.free_stored();
  if (written) note_stored(changed);
  // Also after a failure, e.g. on a full disk: users can fetch the image from memory.
  publish_completions(changed);
  if (!written) return written;
  if (auto settled = settle(); !settled) return settled;
  return unreadable_;
} catch (const std::bad_alloc&) {
  return core::fail(ErrorCode::kResourceExhausted, "out of memory");  // so short that it needs none
}

void Checkpointer::read_events() {
  StateLock(farm_)->checkpoint_is_awaited = false;
  for (bool is_last = false; !is_last;) {
    const events::EventLog::Page page = farm_.events().read(cursor_, kJobsAtOnce);
    if (page.reset) pending_.merge(ids_of_jobs(farm_));
    for (const events::Subject& subject : page.subjects)
      if (subject.kind == events::SubjectKind::kJob) pending_.insert(subject.id);
    cursor_ = page.next;
    is_last = page.is_last;
  }
}

core::Status Checkpointer::write(const std::vector<farm::JobSnapshot>& changed) {
  if (auto there = store_.expect_file(); !there) return there;
  if (auto written = write_tiles(); !written) return written;
  for (const farm::JobSnapshot& job : changed) {
    if (held_back_.contains(job.spec->id())) continue;
    if (auto written = store_.update_job(to_row(job)); !written) return written;
  }
  return {};
}

std::vector<farm::JobSnapshot> Checkpointer::changed_jobs() {
  std::vector<farm::JobSnapshot> changed;
  in_parts(pending_, [&](auto id, auto last) {
    const StateLock lock(farm_);
    for (; id != last; ++id) {
      const JobRecord* const record = lock->find_job(*id);
      if (record != nullptr && record->revision != record->stored_revision)
        changed.emplace_back(*record, *lock->scheduler.job({*id}, lock.now()));
    }
  });
  return changed;
}

std::vector<FilmOfJob> Checkpointer::films() {
  std::vector<FilmOfJob> films;
  in_parts(pending_, [&](auto id, auto last) {
    const StateLock lock(farm_);
    for (; id != last; ++id) {
      const JobRecord* const record = lock->find_job(*id);
      if (record != nullptr && record->film) films.push_back({record->spec, record->film});
    }
  });
  return films;
}

// Batches span films: each costs a write to the disk.
core::Status Checkpointer::write_tiles() {
  TileBatch batch;
  for (const FilmOfJob& film : films()) {
    film.film->apply();
    for (ChangedTiles tiles(*film.film); tiles.first(); tiles.pop()) {
      take(film, *tiles.first(), batch);
      if (!batch.is_full()) continue;
      if (auto written = write(batch); !written) return written;
    }
  }
  return write(batch);
}

core::Status Checkpointer::write(TileBatch& batch) {
  if (batch.is_empty()) return {};
  if (auto written = store_.write_tiles(batch.rows()); !written) return written;
  batch.note_stored();
  return {};
}

void Checkpointer::take(const FilmOfJob& film, int tile, TileBatch& batch) {
  TakenTile* const taken = batch.take(film, tile);
  if (taken == nullptr) return;
  auto row = encode(film, *taken);
  if (row) return batch.add_row(std::move(*row));
  batch.give_back_last();
  note_unreadable(film, tile, row.error());
}

core::Result<store::TileRow> Checkpointer::encode(const FilmOfJob& film, TakenTile& tile) {
  const film::TileSnapshot& parts = tile.to_store.parts;
  if (!parts.stored.empty()) {
    auto whole = films_.whole(*film.spec, tile.tile, tile.to_store);
    if (!whole) return core::fail(whole.error());
    tile.whole = std::move(*whole);
  }
  const film::TilePart* const all = tile.whole ? tile.whole.get() : parts.storing.get();
  if (all != nullptr)
    all->copy_to(content_.sums);
  else
    content_.sums = {};
  content_.counters = tile.to_store.counters;
  content_.provenance = provenance_of(film, tile.tile);
  film.film->note_producers(content_.provenance.items);
  store::TileRow row = film::encode_tile_row(film.spec->id(), tile.tile, film.film->grid().rect(tile.tile),
                                             tile.to_store.samples.ranges(), content_);
  row.revision = parts.revision;
  return row;
}

film::Produced Checkpointer::provenance_of(const FilmOfJob& film, int tile) {
  const StateLock lock(farm_);
  if (lock->find_job(film.spec->id()) == nullptr) return {};  // deleted meanwhile
  return {fingerprinter_.check(), lock->scheduler.provenance({film.spec->id()}, tile)};
}

void Checkpointer::note_unreadable(const FilmOfJob& film, int tile, const core::Error& error) {
  const std::string& id = film.spec->id();
  if (StateLock(farm_)->find_job(id) == nullptr) return;  // deleted meanwhile, and its tiles with it
  held_back_.insert(id);
  if (error.code == ErrorCode::kDataLoss) return replace_lost(film, tile, error);
  if (unreadable_) unreadable_ = core::fail(error);
}

void Checkpointer::replace_lost(const FilmOfJob& film, int tile, const core::Error& error) {
  film::Notes spare(1);
  const auto drop = [&]() noexcept {  // the scheduler and the film must agree
    StateLock lock(farm_);
    const bool dropped = !lock.handle(scheduler::DropTile{{film.spec->id()}, tile}).dropped_tiles.empty();
    if (dropped) film.film->note_clear(tile, spare);
    return dropped;
  };
  const common::LogFields fields{.job = film.spec->id()};
  if (drop()) return common::log(spdlog::level::err, error.message + ": it is rendered again", fields);
  film.film->forget_stored(tile);
  common::log(spdlog::level::err,
              error.message + ": its job is not rendered any more, and its image lacks these samples",
              fields);
}

void Checkpointer::note_stored(const std::vector<farm::JobSnapshot>& stored) {
  for (const farm::JobSnapshot& job : stored) {
    if (held_back_.contains(job.spec->id())) continue;
    StateLock lock(farm_);
    JobRecord* const record = lock->find_job(job.spec->id());
    if (record != nullptr) record->stored_revision = job.revision;
  }
}

// Jobs that are finished stay pending until they have left the memory.
core::Status Checkpointer::settle() {
  std::vector<farm::JobSnapshot> finished;
  std::erase_if(pending_, [&](const std::string& id) { return is_stored(id, finished); });
  std::vector<store::JobRow> rows;
  for (const farm::JobSnapshot& job : finished) {
    rows.push_back(to_row(job));
    rows.back().revision = job.last_event;
    rows.back().settled = true;
  }
  if (rows.empty()) return {};
  if (auto settled = store_.settle_jobs(rows); !settled) return settled;
  for (const farm::JobSnapshot& job : finished)
    if (release(job)) pending_.erase(job.spec->id());
  return {};
}

bool Checkpointer::is_stored(const std::string& id, std::vector<farm::JobSnapshot>& finished) {
  std::optional<farm::JobSnapshot> job;
  bool is_over = false;
  {
    const StateLock lock(farm_);
    const JobRecord* const record = lock->find_job(id);
    if (record == nullptr) return true;
    if (record->revision != record->stored_revision) return false;
    is_over = is_settled(*record);
    job.emplace(*record, *lock->scheduler.job({id}, lock.now()));
  }
  if (job->film && !job->film->is_stored()) return false;
  if (is_over) finished.push_back(*std::move(job));
  return !is_over;
}

bool Checkpointer::is_settled(const JobRecord& record) {
  return !record.is_open && !record.row_is_left && !record.unpublished_completion &&
         record.revision == record.stored_revision;
}

// A job that has changed since stays in memory: its next row is not settled.
bool Checkpointer::release(const farm::JobSnapshot& job) {
  const std::string& id = job.spec->id();
  files_.note_stored(job.spec->bundle());                // before its hold ends
  std::map<std::string, JobRecord>::node_type released;  // destroyed without the lock
  StateLock lock(farm_);
  const JobRecord* const record = lock->find_job(id);
  if (record == nullptr) return true;
  const bool is_same = is_settled(*record) && record->last_event == job.last_event &&
                       record->film == job.film && (!job.film || job.film->is_stored());
  if (!is_same || !lock.handle(scheduler::ReleaseJob{{id}}).status) return false;
  released = lock->remove_job(id);
  return true;
}

void Checkpointer::publish_completions(const std::vector<farm::JobSnapshot>& stored) {
  for (const farm::JobSnapshot& job : stored) {
    if (!job.is_unpublished) continue;
    StateLock lock(farm_);
    JobRecord* const record = lock->find_job(job.spec->id());
    if (record == nullptr || !record->unpublished_completion ||
        *record->unpublished_completion > job.revision)
      continue;
    record->unpublished_completion.reset();
    lock.note_progress(*record);
  }
}

}  // namespace tessera::jobs
