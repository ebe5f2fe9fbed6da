// SPDX-License-Identifier: Apache-2.0
// The coordinator's side of Synchronize: heartbeats of workers, and leases for them.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/base/printable.hpp"
#include "proto/text.hpp"
#include "proto/worker_key.hpp"
#include "server/dispatch/dispatcher.hpp"
#include "server/farm/wire.hpp"

namespace tessera::dispatch {

using core::ErrorCode;
using farm::JobRecord;
using farm::StateLock;

namespace {

bool is_registered(const StateLock& lock, const std::string& id) {
  return lock->scheduler.worker({id}, lock.now()).has_value();
}

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

core::Error quarantined(const v1::SynchronizeRequest& request, const std::string& because) {
  return {
      ErrorCode::kFailedPrecondition,
      fmt::format("worker {} is quarantined: {} (the coordinator's log says more). Check the machine and its "
                  "memory; then remove worker.key from its cache folder and start the worker again, or "
                  "restart the coordinator",
                  request.name(), because)};
}

core::Error not_compatible(const v1::SynchronizeRequest& request, const std::string& fingerprint) {
  return {
      ErrorCode::kFailedPrecondition,
      fmt::format(
          "worker {} (release {}) is not bit-compatible with this farm: its fingerprint is {}, the farm's is "
          "{}. Install the coordinator's release on it; or, for a farm of that release's workers, start the "
          "coordinator with --accept-fingerprint {}",
          core::printable(request.name()), core::printable(request.version()),
          core::printable(request.determinism_fingerprint()), fingerprint,
          core::printable(request.determinism_fingerprint()))};
}

core::Status admit(StateLock& lock, const v1::SynchronizeRequest& request) {
  if (lock->closed) return core::fail(ErrorCode::kUnavailable, "the coordinator is stopping: try again");
  // Workers that were registered before their machine was quarantined are judged by their own results.
  const std::string machine = proto::client_key(request.worker_key());
  const std::string& id = request.worker_id();
  const bool newcomer = lock->quarantine.is_machine_aside(machine) && !is_registered(lock, id);
  if (newcomer || lock->quarantine.is_quarantined(id))
    return core::fail(quarantined(request, lock->quarantine.because(id, machine)));
  const std::string& fingerprint = lock.options().fingerprint;
  if (request.determinism_fingerprint() == fingerprint) return {};
  core::Error error = not_compatible(request, fingerprint);
  lock.log_rejection("refused: " + error.message);
  return core::fail(std::move(error));
}

void note_troubles(StateLock& lock, const v1::SynchronizeRequest& request) {
  for (std::string& sentence : lock->troubles.note(request)) lock.log_trouble(std::move(sentence));
}

scheduler::Synchronize event_of(const StateLock& lock, const v1::SynchronizeRequest& request,
                                const std::string& principal, const std::vector<const v1::Lease*>& held,
                                const std::set<std::string>& fetching) {
  scheduler::Synchronize event{info_of(request, principal),
                               {},
                               static_cast<int>(std::min<std::uint32_t>(request.wanted_leases(), 1024)),
                               request.draining()};
  if (request.has_rendering()) {
    event.rendering = {{request.rendering().lease_id()}, {}, {}};
    if (const JobRecord* record = lock->find_job(request.rendering().job_id()))
      event.rendering = farm::from_wire(request.rendering(), farm::grid_of(*record->spec));
  }
  for (const std::string& job : fetching) {
    if (lock->find_job(job) != nullptr) event.fetching.insert({job});
  }
  for (const v1::Lease* lease : held) {
    if (const JobRecord* record = lock->find_job(lease->job_id()))
      event.held.push_back(farm::from_wire(*lease, farm::grid_of(*record->spec)));
  }
  return event;
}

}  // namespace

void Dispatcher::synchronize(const v1::SynchronizeRequest& request, farm::SynchronizeCaller caller) {
  const core::Status valid = check_request(request);
  const std::vector<const v1::Lease*> held = held_leases(request);
  const std::set<std::string> fetching = first_ids(request.fetching_job_ids(), kMaxFetchingJobs);
  std::set<std::string> known_jobs = first_ids(request.known_job_ids(), kMaxKnownJobs);
  StateLock lock(farm_);
  const core::Status admitted = valid ? admit(lock, request) : valid;
  if (!admitted) return farm::refuse(lock, caller, admitted.error());

  note_troubles(lock, request);
  const scheduler::Synchronize event = event_of(lock, request, caller.principal, held, fetching);
  const scheduler::Actions actions = lock->scheduler.handle(event, lock.now());
  if (!actions.status) {
    lock.apply(actions);
    return farm::refuse(lock, caller, actions.status.error());
  }
  const scheduler::Reply& reply = *actions.reply;
  farm::WaitingCall call{std::move(caller), std::move(known_jobs),
                         lock.now() + reply.heartbeat_timeout / kCallsPerLease};
  const bool lacks_spec = std::any_of(reply.leases.begin(), reply.leases.end(), [&](const auto& lease) {
    return call.known_jobs.count(lease.job.value) == 0;
  });
  const bool nothing_left = request.draining() && reply.leases.empty();
  farm::answer(lock, request.worker_id(), reply);  // an earlier call of this worker
  lock->waiting.emplace(request.worker_id(), std::move(call));
  if (reply.changed || lacks_spec || nothing_left) farm::answer(lock, request.worker_id(), reply);
  lock.apply(actions);
}

}  // namespace tessera::dispatch
