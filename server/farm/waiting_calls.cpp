// SPDX-License-Identifier: Apache-2.0
#include "server/farm/waiting_calls.hpp"

#include <utility>

#include "server/farm/state_lock.hpp"
#include "server/farm/wire.hpp"

namespace tessera::farm {

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
  auto call = lock->waiting.extract(worker);
  if (call.empty()) return;
  lock.later([answer = std::move(call.mapped().caller.answer),
              messages = LeaseMessages(lock, reply, call.mapped().known_jobs)] { answer(messages.build()); });
}

void refuse(StateLock& lock, SynchronizeCaller& caller, const core::Error& error) {
  lock.later([answer = std::move(caller.answer), error] { answer(core::fail(error)); });
}

scheduler::Actions top_up(StateLock& lock, const std::string& worker, bool answer_unchanged) noexcept {
  const auto call = lock->waiting.find(worker);
  if (call == lock->waiting.end()) return {};
  if (call->second.caller.is_gone()) {
    refuse(lock, call->second.caller, {core::ErrorCode::kCancelled, "the caller has gone"});
    lock->waiting.erase(call);
    return {};
  }
  scheduler::Actions actions = lock->scheduler.handle(scheduler::TopUp{{worker}}, lock.now());
  if (!actions.status) {
    refuse(lock, call->second.caller, actions.status.error());
    lock->waiting.erase(call);
  } else if (actions.reply->changed || answer_unchanged) {
    answer(lock, worker, *actions.reply);
  }
  return actions;
}

}  // namespace tessera::farm
