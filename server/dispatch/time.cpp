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
#include "server/farm/steps.hpp"

namespace tessera::dispatch {

using farm::JobRecord;
using farm::StateLock;

namespace {

constexpr auto kCheckPeriod = std::chrono::seconds(1);

// Jobs, leases and workers that are checked in a second.
constexpr std::size_t kChecksAtOnce = 200;

// A job may have no auditor for a moment between two leases.
constexpr int kChecksUntilSaid = 5;

// How many calls are answered under one hold of the state lock, which takes longer than to look at them.
constexpr std::size_t kAnsweredAtOnce = 16;

// Returns whether more may be due.
bool answer_due_calls(StateLock& lock) {
  const std::vector<std::string> due = lock->waiting.due(lock.now(), kAnsweredAtOnce);
  for (const std::string& worker : due) lock.apply(farm::top_up(lock, worker, true));
  return due.size() == kAnsweredAtOnce;
}

// Callers that have gone are given nothing in any case; this only removes them. Looks at calls from this
// worker's on. Returns where to go on; empty at the end.
std::optional<std::string> remove_gone(StateLock& lock, const std::string& from) {
  std::vector<std::string> gone;
  const auto& calls = lock->waiting.all();
  auto next = calls.lower_bound(from);
  for (std::size_t i = 0; i < farm::kVisitedAtOnce && next != calls.end(); ++i, ++next)
    if (next->second.caller.is_gone()) gone.push_back(next->first);
  std::optional<std::string> rest;
  if (next != calls.end()) rest = next->first;
  for (const std::string& worker : gone) lock.apply(farm::top_up(lock, worker, true));
  return rest;
}

// Warns once about the job if no present worker can do its remaining audits.
void note_lack_of_auditors(StateLock& lock, JobRecord& record) {
  if (!record.is_open) return;
  const std::string& id = record.spec->id();
  const bool waits = lock->scheduler.awaits_auditors({id});
  record.checks_without_auditor = waits ? record.checks_without_auditor + 1 : 0;
  if (record.checks_without_auditor != kChecksUntilSaid) return;
  lock.log(spdlog::level::warn,
           fmt::format("job {} ({}) lacks nothing but {} samples to verify: start a worker of another name "
                       "(--name), where workers have individual tokens with another token",
                       id, record.spec->name(), lock->scheduler.job({id}, lock.now())->samples_to_verify),
           {.job = id});
}

void answer_due_calls(farm::Farm& farm) {
  for (bool any_left = true; any_left;) {
    StateLock lock(farm);
    any_left = answer_due_calls(lock);
  }
}

void remove_gone(farm::Farm& farm) {
  for (std::optional<std::string> next(""); next;) {
    StateLock lock(farm);
    next = remove_gone(lock, *next);
  }
}

}  // namespace

bool Dispatcher::tick() {
  const bool check = advance_time();
  answer_due_calls(farm_);
  if (check) remove_gone(farm_);
  if (check)
    farm::visit_in_steps(
        farm_, &farm::State::jobs,
        [](StateLock& lock, const std::string&, JobRecord& record) { note_lack_of_auditors(lock, record); });
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
  while (lock->waiting.size() > 0) {
    const std::string worker = lock->waiting.all().begin()->first;
    farm::refuse(lock, lock->waiting.take(worker).caller,
                 {core::ErrorCode::kUnavailable, "the coordinator is stopping: try again"});
  }
}

}  // namespace tessera::dispatch
