// SPDX-License-Identifier: Apache-2.0
// The coordinator's side of Synchronize: heartbeats of workers, and leases for them.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/base/printable.hpp"
#include "proto/text.hpp"
#include "proto/worker_key.hpp"
#include "server/coordinator/state_lock.hpp"
#include "server/coordinator/wire.hpp"

namespace tessera::coordinator {

using core::ErrorCode;

namespace {

// Waiting calls are answered three times per heartbeat timeout.
constexpr int kCallsPerLease = 3;

bool is_id(const std::string& text) {
  return text.size() == 32 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

core::Status check_request(const v1::SynchronizeRequest& request) {
  if (!is_id(request.worker_id())) {
    return core::fail(ErrorCode::kInvalidArgument, "worker_id: must be 32 lower-case hexadecimal digits");
  }
  if (request.determinism_fingerprint().empty()) {
    return core::fail(ErrorCode::kInvalidArgument, "determinism_fingerprint: must not be empty");
  }
  if (auto fit = proto::check_text("name", request.name()); !fit) return fit;
  if (auto fit = proto::check_text("version", request.version()); !fit) return fit;
  return proto::check_text("determinism_fingerprint", request.determinism_fingerprint());
}

scheduler::WorkerInfo info_of(const v1::SynchronizeRequest& request, const std::string& principal) {
  const int threads = static_cast<int>(std::clamp<std::uint32_t>(request.threads(), 1, 4096));
  return {{request.worker_id()},
          request.name(),
          request.version(),
          threads,
          proto::client_key(request.worker_key()),
          principal};
}

// Bounds on what is examined under the lock of a worker's request. A worker can hold kMaxLeasesPerWorker
// leases and still report as many that have ended.
constexpr int kMaxHeldLeases = 2 * scheduler::kMaxLeasesPerWorker;
constexpr int kMaxHeldItems = kMaxHeldLeases * static_cast<int>(scheduler::kMaxItemsPerLease);
constexpr std::size_t kMaxKnownJobs = 256, kMaxFetchingJobs = 64;

// The leases within these bounds, in the order of the request.
std::vector<const v1::Lease*> held_leases(const v1::SynchronizeRequest& request) {
  std::vector<const v1::Lease*> held;
  int items = 0;
  for (const v1::Lease& lease : request.held()) {
    items += lease.items_size();
    if (held.size() == kMaxHeldLeases || items > kMaxHeldItems) break;
    held.push_back(&lease);
  }
  return held;
}

std::set<std::string> first_ids(const google::protobuf::RepeatedPtrField<std::string>& ids,
                                std::size_t most) {
  const auto end =
      ids.begin() + static_cast<std::ptrdiff_t>(std::min(most, static_cast<std::size_t>(ids.size())));
  return {ids.begin(), end};
}

}  // namespace

void Coordinator::synchronize(const v1::SynchronizeRequest& request, SynchronizeCaller caller) {
  core::Status admitted = check_request(request);
  const std::vector<const v1::Lease*> held = held_leases(request);
  const std::set<std::string> fetching = first_ids(request.fetching_job_ids(), kMaxFetchingJobs);
  std::set<std::string> known_jobs = first_ids(request.known_job_ids(), kMaxKnownJobs);
  StateLock lock(*this);
  if (admitted && closed_)
    admitted = core::fail(ErrorCode::kUnavailable, "the coordinator is stopping: try again");
  if (admitted) admitted = admit(lock, request);
  if (!admitted) return refuse(lock, caller, admitted.error());

  note_troubles(lock, request);
  scheduler::Synchronize event{info_of(request, caller.principal),
                               {},
                               static_cast<int>(std::min<std::uint32_t>(request.wanted_leases(), 1024)),
                               request.draining()};
  if (request.has_rendering()) {
    event.rendering = {{request.rendering().lease_id()}, {}, {}};
    if (const JobRecord* record = find(request.rendering().job_id()))
      event.rendering = from_wire(request.rendering(), grid_of(*record->spec));
  }
  for (const std::string& job : fetching) {
    if (find(job) != nullptr) event.fetching.insert({job});
  }
  for (const v1::Lease* lease : held) {
    if (const JobRecord* record = find(lease->job_id()))
      event.held.push_back(from_wire(*lease, grid_of(*record->spec)));
  }
  const scheduler::Actions actions = scheduler_.handle(event, lock.now());
  if (!actions.status) {
    apply(lock, actions);
    return refuse(lock, caller, actions.status.error());
  }
  const scheduler::Reply& reply = *actions.reply;
  ParkedCall call{std::move(caller), std::move(known_jobs),
                  lock.now() + reply.heartbeat_timeout / kCallsPerLease};
  const bool lacks_spec = std::any_of(reply.leases.begin(), reply.leases.end(), [&](const auto& lease) {
    return call.known_jobs.count(lease.job.value) == 0;
  });
  const bool nothing_left = request.draining() && reply.leases.empty();
  release_parked(lock, request.worker_id(), reply);  // an earlier call of this worker
  parked_.emplace(request.worker_id(), std::move(call));
  if (reply.changed || lacks_spec || nothing_left) release_parked(lock, request.worker_id(), reply);
  apply(lock, actions);
}

void Coordinator::refuse(StateLock& lock, SynchronizeCaller& caller, const core::Error& error) {
  lock.later([answer = std::move(caller.answer), error] { answer(core::fail(error)); });
}

core::Status Coordinator::admit(const StateLock& lock, const v1::SynchronizeRequest& request) {
  // Workers that were registered before their machine was quarantined are judged by their own results.
  const std::string machine = proto::client_key(request.worker_key());
  const bool newcomer = quarantine_.is_machine_aside(machine) && !is_known(lock, request.worker_id());
  if (quarantine_.is_quarantined(request.worker_id()) || newcomer) {
    return core::fail(
        ErrorCode::kFailedPrecondition,
        fmt::format(
            "worker {} is quarantined: {} (the coordinator's log says more). Check the machine and its "
            "memory; then remove worker.key from its cache folder and start the worker again, or "
            "restart the coordinator",
            request.name(), quarantine_.because(request.worker_id(), machine)));
  }
  if (request.determinism_fingerprint() == options_.fingerprint) return {};
  core::Error error{
      ErrorCode::kFailedPrecondition,
      fmt::format(
          "worker {} (release {}) is not bit-compatible with this farm: its fingerprint is {}, the farm's is "
          "{}. Install the coordinator's release on it; or, for a farm of that release's workers, start the "
          "coordinator with --accept-fingerprint {}",
          core::printable(request.name()), core::printable(request.version()),
          core::printable(request.determinism_fingerprint()), options_.fingerprint,
          core::printable(request.determinism_fingerprint()))};
  rejected_log_.warn("refused: " + error.message, lock.now());
  return core::fail(std::move(error));
}

bool Coordinator::is_known(const StateLock& lock, const std::string& id) const {
  const auto workers = scheduler_.workers(lock.now());
  return std::any_of(workers.begin(), workers.end(),
                     [&](const scheduler::WorkerView& worker) { return worker.info.id.value == id; });
}

void Coordinator::note_troubles(const StateLock& lock, const v1::SynchronizeRequest& request) {
  for (std::string& sentence : troubles_.note(request)) troubles_log_.warn(std::move(sentence), lock.now());
}

scheduler::Actions Coordinator::top_up(StateLock& lock, const std::string& worker, bool answer_unchanged) {
  const auto call = parked_.find(worker);
  if (call == parked_.end()) return {};
  if (call->second.caller.is_gone()) {
    refuse(lock, call->second.caller, {ErrorCode::kCancelled, "the caller has gone"});
    parked_.erase(call);
    return {};
  }
  scheduler::Actions actions = scheduler_.handle(scheduler::TopUp{{worker}}, lock.now());
  if (!actions.status) {
    refuse(lock, call->second.caller, actions.status.error());
    parked_.erase(call);
  } else if (actions.reply->changed || answer_unchanged) {
    release_parked(lock, worker, *actions.reply);
  }
  return actions;
}

void Coordinator::release_parked(StateLock& lock, const std::string& worker, const scheduler::Reply& reply) {
  auto call = parked_.extract(worker);
  if (call.empty()) return;
  lock.later([answer = std::move(call.mapped().caller.answer),
              response = respond(reply, call.mapped().known_jobs)] { answer(response); });
}

v1::SynchronizeResponse Coordinator::respond(const scheduler::Reply& reply,
                                             const std::set<std::string>& known_jobs) {
  v1::SynchronizeResponse response;
  std::set<std::string> described;
  for (const scheduler::LeaseDescription& lease : reply.leases) {
    const v1::Job& spec = *jobs_.at(lease.job.value).spec;
    *response.add_leases() = to_wire(lease, grid_of(spec));
    if (known_jobs.contains(spec.id()) || !described.insert(spec.id()).second) continue;
    v1::JobSpec* job = response.add_jobs();
    job->set_job_id(spec.id());
    *job->mutable_bundle() = spec.bundle();
    *job->mutable_settings() = spec.settings();
  }
  *response.mutable_heartbeat_timeout() = to_wire(reply.heartbeat_timeout);
  return response;
}

}  // namespace tessera::coordinator
