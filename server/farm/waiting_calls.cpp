// SPDX-License-Identifier: Apache-2.0
#include "server/farm/waiting_calls.hpp"

#include <utility>

#include "server/farm/state_lock.hpp"
#include "server/farm/wire.hpp"

namespace tessera::farm {

void WaitingCalls::add(const std::string& worker, WaitingCall call) {
  by_deadline_.emplace(call.deadline, worker);
  calls_.emplace(worker, std::move(call));
}

WaitingCall* WaitingCalls::find(const std::string& worker) {
  const auto found = calls_.find(worker);
  return found == calls_.end() ? nullptr : &found->second;
}

const WaitingCall* WaitingCalls::find(const std::string& worker) const {
  const auto found = calls_.find(worker);
  return found == calls_.end() ? nullptr : &found->second;
}

WaitingCall WaitingCalls::take(const std::string& worker) {
  auto taken = calls_.extract(worker);
  by_deadline_.erase({taken.mapped().deadline, worker});
  return std::move(taken.mapped());
}

std::vector<std::string> WaitingCalls::due(scheduler::Time now, std::size_t most) const {
  std::vector<std::string> workers;
  for (auto next = by_deadline_.begin(); next != by_deadline_.end() && workers.size() < most; ++next) {
    if (next->first > now) break;
    workers.push_back(next->second);
  }
  return workers;
}

LeaseMessages::LeaseMessages(const StateLock& lock, scheduler::Reply reply,
                             const std::set<std::string>& known_jobs)
    : reply_(std::move(reply)) {
  for (const scheduler::LeaseDescription& lease : reply_.leases) {
    const std::string& job = lease.job.value;
    if (specs_.contains(job)) continue;
    specs_.emplace(job, lock->find_job(job)->spec);
    if (!known_jobs.contains(job)) unknown_jobs_.insert(job);
  }
}

v1::SynchronizeResponse LeaseMessages::build() const {
  v1::SynchronizeResponse response;
  for (const scheduler::LeaseDescription& lease : reply_.leases)
    *response.add_leases() = to_wire(lease, grid_of(*specs_.at(lease.job.value)));
  for (const std::string& id : unknown_jobs_) {
    const v1::Job& spec = *specs_.at(id);
    v1::JobSpec* job = response.add_jobs();
    job->set_job_id(id);
    *job->mutable_bundle() = spec.bundle();
    *job->mutable_settings() = spec.settings();
    *job->mutable_images() = spec.images();
  }
  *response.mutable_heartbeat_timeout() = to_wire(reply_.heartbeat_timeout);
  response.set_stop(reply_.stop);
  return response;
}

void answer(StateLock& lock, const std::string& worker, const scheduler::Reply& reply) {
  if (lock->waiting.find(worker) == nullptr) return;
  WaitingCall call = lock->waiting.take(worker);
  lock.later([answer = std::move(call.caller.answer),
              messages = LeaseMessages(lock, reply, call.known_jobs)] { answer(messages.build()); });
}

void refuse(StateLock& lock, SynchronizeCaller caller, const core::Error& error) {
  lock.later([answer = std::move(caller.answer), error] { answer(core::fail(error)); });
}

bool refuse_if_gone(StateLock& lock, const std::string& worker) {
  const WaitingCall* const call = lock->waiting.find(worker);
  if (call == nullptr || !call->caller.is_gone()) return false;
  refuse(lock, lock->waiting.take(worker).caller, {core::ErrorCode::kCancelled, "the caller has gone"});
  return true;
}

scheduler::Actions top_up(StateLock& lock, const std::string& worker, bool answer_unchanged) noexcept {
  if (lock->waiting.find(worker) == nullptr || refuse_if_gone(lock, worker)) return {};
  scheduler::Actions actions = lock->scheduler.handle(scheduler::TopUp{{worker}}, lock.now());
  if (!actions.status) {
    refuse(lock, lock->waiting.take(worker).caller, actions.status.error());
  } else if (actions.reply->changed || answer_unchanged) {
    answer(lock, worker, *actions.reply);
  }
  return actions;
}

}  // namespace tessera::farm
