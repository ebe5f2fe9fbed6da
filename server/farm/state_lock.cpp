// SPDX-License-Identifier: Apache-2.0
#include "server/farm/state_lock.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <utility>

#include "core/common/log.hpp"
#include "server/base/wall_clock.hpp"
#include "server/farm/wire.hpp"
#include "server/limits.hpp"

namespace tessera::farm {

namespace {

// Workers that are offered work under one hold of the lock, which takes some ten microseconds for each.
constexpr std::size_t kOffersAtOnce = 16;

// For an operator or another program to free some memory.
constexpr auto kMemoryRetryDelay = std::chrono::seconds(1);

}  // namespace

base::MemoryReserve& StateLock::refilled_reserve(Farm& farm) {
  farm.deferred_reserve_.refill();
  farm.memory_reserve_.refill();
  return farm.memory_reserve_;
}

StateLock::StateLock(Farm& farm)
    : farm_(farm),
      reserve_(refilled_reserve(farm)),
      lock_(farm.mutex_),
      since_(farm.options_.hold_clock()),
      options_(farm.options_),
      events_(farm.events_),
      state_(farm.state_),
      now_(farm.options_.now()) {}

StateLock::~StateLock() {
  const std::chrono::nanoseconds held = options_.hold_clock() - since_;
  lock_.unlock();
  farm_.lock_holds_.observe(held);
  const base::MemoryReserve::Scope without_lock(farm_.deferred_reserve_);
  for (const auto& action : later_) action();
}

core::Status StateLock::expect_memory() const {
  if (farm_.memory_reserve_.is_full() && farm_.deferred_reserve_.is_full()) return {};
  const core::Error error{core::ErrorCode::kResourceExhausted,
                          "the coordinator has not enough memory for this: try again later"};
  return core::fail(server::temporary(error, kMemoryRetryDelay));
}

void StateLock::log(spdlog::level::level_enum level, std::string line, common::LogFields fields) {
  later([line = common::LogLine{std::move(line), std::move(fields), level}] { common::log(line); });
}

void StateLock::log_some(common::RateLimitedLog& some, common::LogLine line) {
  if (auto due = some.note(std::move(line), now_)) later([line = *std::move(due)] { common::log(line); });
}

common::LogFields StateLock::fields_of_worker(const std::string& id) const {
  common::LogFields fields{.worker = id};
  if (const scheduler::WorkerInfo* const info = state_.scheduler.worker_info({id}))
    fields.principal = info->principal;
  if (const auto peer = state_.peers.find(id); peer != state_.peers.end()) fields.peer = peer->second;
  return fields;
}

void StateLock::log_suppressed() {
  state_.logs.for_each([this](common::RateLimitedLog& some) {
    if (auto due = some.take_due(now_)) later([line = *std::move(due)] { common::log(line); });
  });
}

JobSnapshot StateLock::snapshot_of(const JobRecord& record) const {
  const std::string& id = record.spec->id();
  scheduler::JobView view = *state_.scheduler.job({id}, now_);
  const bool is_running = view.state == scheduler::JobState::kRunning || record.unpublished_completion;
  return {record, std::move(view), is_running ? state_.troubles.of_job(id) : std::vector<std::string>{}};
}

JobSnapshot StateLock::snapshot_of(const ValidatingJob& job) const {
  JobSnapshot snapshot = farm::snapshot_of(job);
  if (!job.is_begun) snapshot.scenes_ahead = state_.validating_order.order_of_key(job.revision);
  return snapshot;
}

events::Revision StateLock::note_progress(JobRecord& record) {
  const std::string& id = record.spec->id();
  const bool is_over = !record.is_open && !record.unpublished_completion;
  return record.last_event = is_over ? events_.append_end(events::SubjectKind::kJob, id)
                                     : events_.append(events::SubjectKind::kJob, id);
}

void StateLock::note_progress(ValidatingJob& job) {
  job.last_event = events_.append(events::SubjectKind::kJob, job.spec->id());
}

std::map<std::string, JobRecord>::node_type StateLock::remove_job(const std::string& id) noexcept {
  auto removed = state_.remove_job(id);
  events_.append_end(events::SubjectKind::kJob, id);
  return removed;
}

core::Status StateLock::add_job(const scheduler::Event& event, JobRecord record) noexcept {
  const scheduler::Actions actions = state_.scheduler.handle(event, now_);
  if (!actions.status) return core::fail(actions.status.error());
  state_.add_job(std::move(record));
  apply(actions);
  return {};
}

void StateLock::add_validating(ValidatingJob job) noexcept {
  note_progress(state_.add_validating(std::move(job)));
}

std::map<std::string, ValidatingJob>::node_type StateLock::delete_validating(const std::string& id) noexcept {
  auto deleted = state_.remove_validating(id);
  events_.append_end(events::SubjectKind::kJob, id);
  return deleted;
}

void StateLock::note_worker(const std::string& id) {
  if (state_.scheduler.has_worker({id})) {
    events_.append(events::SubjectKind::kWorker, id);
  } else {
    events_.append_end(events::SubjectKind::kWorker, id);
  }
}

void StateLock::quarantine(const scheduler::Producer& producer, const std::string& because) noexcept {
  common::LogFields fields = fields_of_worker(producer.worker.value);
  if (state_.scheduler.worker_info(producer.worker) == nullptr) fields.principal = producer.principal;
  if (!state_.quarantine.add({producer, fields.principal, because, base::wall_clock_ms()})) return;
  note_worker(producer.worker.value);
  log_some(state_.logs.quarantined,
           {fmt::format("worker {} ({}) is quarantined: {}. Its other results are verified by others",
                        called(producer), producer.worker.value, because),
            std::move(fields), spdlog::level::err});
}

scheduler::Actions StateLock::handle(const scheduler::Event& event) noexcept {
  scheduler::Actions actions = state_.scheduler.handle(event, now_);
  apply(actions);
  return actions;
}

void StateLock::apply(const scheduler::Actions& actions) noexcept {
  std::vector<scheduler::Actions> todo{actions};
  while (!todo.empty()) {
    const scheduler::Actions next = std::move(todo.back());
    todo.pop_back();
    follow_audits(next);
    if (!next.discarded.empty()) later([discarded = next.discarded] {});  // destroyed without the lock
    for (const scheduler::JobChange& change : next.job_changes) note_change(change);
    append_events(next);
    for (const scheduler::WorkerId& worker : next.changed_workers) note_presence(worker);
    for (const std::string& stalled : next.stalled) log_some(state_.logs.stalled, {stalled});
    for (const scheduler::WorkerId& worker : next.wake) {
      if (offered_.size() == kOffersAtOnce) {
        offer_later(worker.value);
      } else if (offered_.insert(worker.value).second) {
        todo.push_back(top_up(*this, worker.value, false));
      }
    }
  }
}

// Any thread that takes the lock in between may be given some of the work.
void StateLock::offer_later(const std::string& worker) {
  if (offered_.contains(worker)) return;
  state_.to_offer.push_back(worker);
  if (std::exchange(continues_offers_, true)) return;
  later([&farm = farm_] {
    StateLock lock(farm);
    lock.continue_offers();
  });
}

void StateLock::continue_offers() noexcept {
  while (!state_.to_offer.empty() && offered_.size() < kOffersAtOnce) {
    const std::string worker = std::move(state_.to_offer.front());
    state_.to_offer.pop_front();
    if (offered_.insert(worker).second) apply(top_up(*this, worker, false));
  }
  if (state_.to_offer.empty()) return;
  const std::string next = std::move(state_.to_offer.front());
  state_.to_offer.pop_front();
  offer_later(next);
}

void StateLock::note_presence(const scheduler::WorkerId& worker) {
  const std::string& id = worker.value;
  const auto view = state_.scheduler.worker(worker, now_);
  const auto before = state_.present.find(id);
  if (view && !view->silent && before == state_.present.end()) {
    state_.present.emplace(id, PresentWorker{view->info.name, view->info.principal});
    log_some(state_.logs.registered, {fmt::format("worker {} ({}) registered", view->info.name, id),
                                      fields_of_worker(id), spdlog::level::info});
  } else if ((!view || view->silent) && before != state_.present.end()) {
    common::LogFields fields = fields_of_worker(id);
    fields.principal = before->second.principal;
    log_some(state_.logs.lost,
             {fmt::format("worker {} ({}) is lost", before->second.name, id), std::move(fields)});
    state_.present.erase(before);
  }
  if (view) return;
  state_.quarantine.forget(id);
  state_.drains.forget(id);
  state_.troubles.forget(id);
  state_.caches.erase(id);
  state_.peers.erase(id);
}

void StateLock::append_events(const scheduler::Actions& actions) {
  const auto note_job = [this](const scheduler::JobId& job) {
    if (JobRecord* const record = state_.find_job(job.value)) note_progress(*record);
  };
  for (const auto* const jobs : {&actions.changed_jobs, &actions.progressed_jobs})
    for (const scheduler::JobId& job : *jobs) note_job(job);
  for (const scheduler::TileOfJob& reviewed : actions.reviewed_tiles) note_job(reviewed.job);
  for (const auto* const workers : {&actions.changed_workers, &actions.progressed_workers})
    for (const scheduler::WorkerId& worker : *workers) note_worker(worker.value);
}

void StateLock::note_change(const scheduler::JobChange& change) {
  JobRecord* record = state_.find_job(change.id.value);
  if (record == nullptr) return;
  state_.set_open(*record, !is_finished(change.to));
  record->finished_ms.reset();
  record->unpublished_completion.reset();
  this->change(*record);
  if (change.to == scheduler::JobState::kDone || change.to == scheduler::JobState::kFailed) {
    record->unpublished_completion = record->revision;
    state_.checkpoint_is_awaited = true;
  }
  const std::int64_t now_ms = base::wall_clock_ms();
  record->life.note(event_of(change.to), now_ms);
  if (is_finished(change.to)) record->finished_ms = now_ms;
  log(spdlog::level::info,
      fmt::format("job {} ({}) is {}", change.id.value, record->spec->name(),
                  scheduler::job_state_name(change.to)),
      {.job = change.id.value});
  if (change.to == scheduler::JobState::kFailed) {
    log(spdlog::level::err,
        fmt::format("job {}: {}", change.id.value, state_.scheduler.job(change.id, {})->failure),
        {.job = change.id.value});
  }
}

void StateLock::note_first_samples(JobRecord& record) {
  const std::int64_t now_ms = base::wall_clock_ms();
  record.life.note(v1::JobEvent::KIND_STARTED, now_ms);
  const std::int64_t since = now_ms - ms_from_timestamp(record.spec->created_at());
  farm_.first_samples_.observe(std::chrono::milliseconds(std::max<std::int64_t>(since, 0)));
}

void StateLock::follow_audits(const scheduler::Actions& actions) {
  for (const scheduler::TileOfJob& reviewed : actions.reviewed_tiles) {
    const JobRecord* const record = state_.find_job(reviewed.job.value);
    if (record == nullptr || !record->film) continue;
    film::Notes spare(1);
    record->film->note_review(reviewed.tile, spare);
  }
  for (const scheduler::Disproof& disproof : actions.disproved) {
    quarantine(disproof.producer, disproof.because);
  }
  for (const std::string& contradiction : actions.contradictions) log(spdlog::level::warn, contradiction);
  state_.to_search.insert(state_.to_search.end(), actions.distrusted.begin(), actions.distrusted.end());
  for (const scheduler::JobId& job : actions.reopen) state_.to_reopen.insert(job.value);
  for (const scheduler::Unattended& unattended : actions.unattended) {
    const std::string& id = unattended.job.value;
    const JobRecord* const record = state_.find_job(id);
    if (record == nullptr) continue;
    log(spdlog::level::warn,
        fmt::format("job {} ({}) lacks nothing but {} samples to verify: start a worker of another name "
                    "(--name), where workers have individual tokens with another token",
                    id, record->spec->name(), unattended.samples),
        {.job = id});
  }
  for (const scheduler::Unaudited& unaudited : actions.unaudited) {
    log(spdlog::level::warn,
        fmt::format(
            "job {}: {} ranges that were chosen to be audited were not: there was no worker of another name",
            unaudited.job.value, unaudited.ranges),
        {.job = unaudited.job.value});
  }
}

}  // namespace tessera::farm
