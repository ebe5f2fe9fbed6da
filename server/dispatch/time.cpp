// SPDX-License-Identifier: Apache-2.0
// The passing of time: what the coordinator does ten times a second, and once a second.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/common/log.hpp"
#include "server/dispatch/dispatcher.hpp"

namespace tessera::dispatch {

using farm::JobRecord;
using farm::StateLock;

namespace {

constexpr auto kCheckPeriod = std::chrono::seconds(1);

// Jobs, leases and workers that are checked in a second.
constexpr std::size_t kChecksAtOnce = 200;

// A job may have no auditor for a moment between two leases.
constexpr int kChecksUntilSaid = 5;

// What is looked at under one hold of the state lock, and what of it is answered, which takes longer.
constexpr std::size_t kLookedAtAtOnce = 256, kAnsweredAtOnce = 16;

// Answers calls that are due, from this worker's on. Returns where to go on; empty at the end.
std::optional<std::string> answer_due_calls(StateLock& lock, const std::string& from, bool look_for_gone) {
  // Callers that have gone are given nothing in any case; this only removes them.
  std::vector<std::string> due;
  std::size_t looked_at = 0;
  auto next = lock->waiting.lower_bound(from);
  for (; next != lock->waiting.end(); ++next) {
    if (looked_at++ == kLookedAtAtOnce || due.size() == kAnsweredAtOnce) break;
    const farm::WaitingCall& call = next->second;
    if (call.deadline <= lock.now() || (look_for_gone && call.caller.is_gone())) due.push_back(next->first);
  }
  std::optional<std::string> rest;
  if (next != lock->waiting.end()) rest = next->first;
  for (const std::string& worker : due) lock.apply(farm::top_up(lock, worker, true));
  return rest;
}

// Warns once about the job if no present worker can do its remaining audits.
void note_lack_of_auditors(StateLock& lock, JobRecord& record) {
  if (!record.is_open) return;
  const std::string& id = record.spec->id();
  const scheduler::JobView view = *lock->scheduler.job({id}, lock.now());
  const bool waits = view.state == scheduler::JobState::kRunning && view.samples_done == view.samples_total &&
                     view.active_workers == 0;
  record.checks_without_auditor = waits ? record.checks_without_auditor + 1 : 0;
  if (record.checks_without_auditor != kChecksUntilSaid) return;
  lock.log(spdlog::level::warn,
           fmt::format("job {} ({}) lacks nothing but {} samples to verify: start a worker of another name "
                       "(--name), where workers have individual tokens with another token",
                       id, record.spec->name(), view.samples_to_verify),
           {.job = id});
}

// Looks at jobs from this one on. Returns where to go on; empty at the end.
std::optional<std::string> note_lack_of_auditors(StateLock& lock, const std::string& from) {
  auto next = lock->jobs.lower_bound(from);
  for (std::size_t i = 0; i < kLookedAtAtOnce && next != lock->jobs.end(); ++i, ++next)
    note_lack_of_auditors(lock, next->second);
  if (next == lock->jobs.end()) return std::nullopt;
  return next->first;
}

// Calls step(lock, from) from the start on, each time under a new hold of the lock, until it returns nothing.
template <typename Step>
void in_steps(farm::Farm& farm, Step step) {
  for (std::optional<std::string> next(""); next;) {
    StateLock lock(farm);
    next = step(lock, *next);
  }
}

}  // namespace

bool Dispatcher::tick() {
  const bool check = advance_time();
  in_steps(farm_,
           [check](StateLock& lock, const std::string& from) { return answer_due_calls(lock, from, check); });
  if (check)
    in_steps(farm_,
             [](StateLock& lock, const std::string& from) { return note_lack_of_auditors(lock, from); });
  return StateLock(farm_)->checkpoint_is_awaited || film_memory_.is_scarce();
}

bool Dispatcher::advance_time() {
  StateLock lock(farm_);
  lock.handle(scheduler::Tick{});
  if (lock.now() < next_check_) return false;
  next_check_ = lock.now() + kCheckPeriod;
  lock.log_suppressed();
  if (const auto broken = lock->scheduler.check_some(check_cursor_, kChecksAtOnce))
    common::abort_with(*broken);
  return true;
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
