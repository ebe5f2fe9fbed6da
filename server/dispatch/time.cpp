// SPDX-License-Identifier: Apache-2.0
// The passing of time: what the coordinator does ten times a second, and once a second.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <utility>

#include "proto/log.hpp"
#include "server/dispatch/dispatcher.hpp"

namespace tessera::dispatch {

using farm::StateLock;

namespace {

constexpr auto kCheckPeriod = std::chrono::seconds(1);

// Jobs, leases and workers that are checked in a second.
constexpr std::size_t kChecksAtOnce = 200;

// A job may have no auditor for a moment between two leases.
constexpr int kChecksUntilSaid = 5;

void answer_due_calls(StateLock& lock, bool look_for_gone) {
  // Callers that have gone are given nothing in any case; this only removes them.
  std::vector<std::string> due;
  for (const auto& [worker, call] : lock->waiting) {
    if (call.deadline <= lock.now() || (look_for_gone && call.caller.is_gone())) due.push_back(worker);
  }
  for (const std::string& worker : due) lock.apply(farm::top_up(lock, worker, true));
}

void note_workers(StateLock& lock) {
  std::map<std::string, std::string> present;
  std::set<std::string> known;
  for (const scheduler::WorkerView& worker : lock->scheduler.workers(lock.now())) {
    known.insert(worker.info.id.value);
    if (!worker.silent) present.emplace(worker.info.id.value, worker.info.name);
  }
  lock->quarantine.forget_others(known);
  lock->troubles.forget_others(known);
  for (const auto& [id, name] : present) {
    if (!lock->present.contains(id))
      lock.log(spdlog::level::info, fmt::format("worker {} ({}) registered", name, id));
  }
  for (const auto& [id, name] : lock->present) {
    if (!present.contains(id)) lock.log(spdlog::level::warn, fmt::format("worker {} ({}) is lost", name, id));
  }
  lock->present = std::move(present);
}

// Warns once about each job whose remaining audits no present worker can do.
void note_lack_of_auditors(StateLock& lock) {
  for (auto& [id, record] : lock->jobs) {
    if (!record.is_open) continue;
    const scheduler::JobView view = *lock->scheduler.job({id}, lock.now());
    const bool waits = view.state == scheduler::JobState::kRunning &&
                       view.samples_done == view.samples_total && view.active_workers == 0;
    record.checks_without_auditor = waits ? record.checks_without_auditor + 1 : 0;
    if (record.checks_without_auditor != kChecksUntilSaid) continue;
    lock.log(spdlog::level::warn,
             fmt::format("job {} ({}) lacks nothing but {} samples to verify: start a worker of another name "
                         "(--name)",
                         id, record.spec->name(), view.samples_to_verify));
  }
}

}  // namespace

bool Dispatcher::tick() {
  StateLock lock(farm_);
  lock.handle(scheduler::Tick{});
  const bool check = lock.now() >= next_check_;
  answer_due_calls(lock, check);
  const bool hurry = lock->checkpoint_is_awaited || film_memory_.is_scarce();
  if (!check) return hurry;
  next_check_ = lock.now() + kCheckPeriod;
  note_workers(lock);
  lock.log_suppressed();
  note_lack_of_auditors(lock);
  if (const auto broken = lock->scheduler.check_some(check_cursor_, kChecksAtOnce))
    proto::abort_with(*broken);
  return hurry;
}

void Dispatcher::close() {
  StateLock lock(farm_);
  lock->closed = true;
  for (auto& [worker, call] : lock->waiting)
    farm::refuse(lock, call.caller,
                 {core::ErrorCode::kUnavailable, "the coordinator is stopping: try again"});
  lock->waiting.clear();
}

}  // namespace tessera::dispatch
