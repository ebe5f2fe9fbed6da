// SPDX-License-Identifier: Apache-2.0
#include "server/farm/state_lock.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>

#include "server/base/wall_clock.hpp"

namespace tessera::farm {

StateLock::StateLock(Farm& farm)
    : lock_(farm.mutex_), options_(farm.options_), state_(farm.state_), now_(farm.options_.now()) {}

StateLock::~StateLock() {
  lock_.unlock();
  for (const auto& action : later_) action();
}

void StateLock::log(spdlog::level::level_enum level, std::string line) {
  later([level, line = std::move(line)] { spdlog::log(level, "{}", line); });
}

void StateLock::log_some(base::RateLimitedLog& some, std::string line) {
  if (auto due = some.note(std::move(line), now_)) log(spdlog::level::warn, *std::move(due));
}

void StateLock::log_suppressed() {
  for (base::RateLimitedLog* some : {&state_.rejected_log, &state_.troubles_log})
    if (auto due = some->take_due(now_)) log(spdlog::level::warn, *std::move(due));
}

JobSnapshot StateLock::snapshot_of(const JobRecord& record) const {
  const std::string& id = record.spec->id();
  scheduler::JobView view = *state_.scheduler.job({id}, now_);
  const bool is_running = view.state == scheduler::JobState::kRunning || record.unpublished_completion;
  return {record, std::move(view), is_running ? state_.troubles.of_job(id) : std::vector<std::string>{}};
}

scheduler::Actions StateLock::handle(const scheduler::Event& event) {
  scheduler::Actions actions = state_.scheduler.handle(event, now_);
  apply(actions);
  return actions;
}

void StateLock::apply(const scheduler::Actions& actions) {
  std::vector<scheduler::Actions> todo{actions};
  std::set<std::string> asked;  // each worker once: leases for one worker are not free for the next
  while (!todo.empty()) {
    const scheduler::Actions next = std::move(todo.back());
    todo.pop_back();
    follow_audits(next);
    if (!next.discarded.empty()) later([discarded = next.discarded] {});  // destroyed without the lock
    for (const scheduler::JobChange& change : next.job_changes) note_change(change);
    for (const std::string& stalled : next.stalled) log(spdlog::level::warn, stalled);
    for (const scheduler::WorkerId& worker : next.wake) {
      if (asked.insert(worker.value).second) todo.push_back(top_up(*this, worker.value, false));
    }
  }
}

void StateLock::note_change(const scheduler::JobChange& change) {
  JobRecord* record = state_.find_job(change.id.value);
  if (record == nullptr) return;
  ++record->revision;
  record->finished_ms.reset();
  record->unpublished_completion.reset();
  if (change.to == scheduler::JobState::kDone || change.to == scheduler::JobState::kFailed) {
    record->unpublished_completion = record->revision;
    state_.checkpoint_is_awaited = true;
  }
  if (is_finished(change.to)) record->finished_ms = base::wall_clock_ms();
  state_.set_open(*record, !is_finished(change.to));
  log(spdlog::level::info, fmt::format("job {} ({}) is {}", change.id.value, record->spec->name(),
                                       scheduler::job_state_name(change.to)));
  if (change.to == scheduler::JobState::kFailed) {
    log(spdlog::level::err,
        fmt::format("job {}: {}", change.id.value, state_.scheduler.job(change.id, {})->failure));
  }
}

void StateLock::follow_audits(const scheduler::Actions& actions) {
  for (const scheduler::TileOfJob& reviewed : actions.reviewed_tiles) {
    const JobRecord* const record = state_.find_job(reviewed.job.value);
    if (record == nullptr || !record->film) continue;
    film::Notes spare(1);
    record->film->note_review(reviewed.tile, spare);
  }
  for (const scheduler::Disproof& disproof : actions.disproved) {
    const scheduler::Producer& producer = disproof.producer;
    if (!state_.quarantine.quarantined(producer.worker.value, producer.machine, disproof.because)) continue;
    log(spdlog::level::err,
        fmt::format("worker {} ({}) is quarantined: {}. Its other results are verified by others",
                    called(producer), producer.worker.value, disproof.because));
  }
  for (const std::string& contradiction : actions.contradictions) log(spdlog::level::warn, contradiction);
  for (const scheduler::JobId& job : actions.reopen) state_.to_reopen.insert(job.value);
  for (const scheduler::Unaudited& unaudited : actions.unaudited) {
    log(spdlog::level::warn,
        fmt::format(
            "job {}: {} ranges that were chosen to be audited were not: there was no worker of another name",
            unaudited.job.value, unaudited.ranges));
  }
}

}  // namespace tessera::farm
