// SPDX-License-Identifier: Apache-2.0
// The coordinator's side of Synchronize: heartbeats of workers, and leases for them.
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "core/base/printable.hpp"
#include "proto/text.hpp"
#include "proto/worker_key.hpp"
#include "server/dispatch/caller.hpp"
#include "server/dispatch/dispatcher.hpp"
#include "server/farm/wire.hpp"

namespace tessera::dispatch {

using core::ErrorCode;
using farm::JobRecord;
using farm::StateLock;

namespace {

// Waiting calls are answered three times per heartbeat timeout.
constexpr int kCallsPerLease = 3;

core::Status check_request(const v1::SynchronizeRequest& request) {
  if (!is_worker_id(request.worker_id())) {
    return core::fail(ErrorCode::kInvalidArgument, "worker_id: must be 32 lower-case hexadecimal digits");
  }
  if (request.determinism_fingerprint().empty()) {
    return core::fail(ErrorCode::kInvalidArgument, "determinism_fingerprint: must not be empty");
  }
  if (auto fit = proto::check_text("name", request.name()); !fit) return fit;
  if (auto fit = proto::check_text("version", request.version()); !fit) return fit;
  return proto::check_text("determinism_fingerprint", request.determinism_fingerprint());
}

scheduler::WorkerInfo info_of(const v1::SynchronizeRequest& request, const farm::WorkerPrincipal& principal) {
  const int threads = static_cast<int>(std::clamp<std::uint32_t>(request.threads(), 1, 4096));
  return {{request.worker_id()},
          request.name(),
          request.version(),
          threads,
          proto::client_key(request.worker_key()),
          principal.origin,
          principal.name,
          principal.individual,
          request.determinism_fingerprint(),
          {.names_images = request.names_images(), .renders_layers = request.renders_layers()}};
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

core::Error quarantined(const v1::SynchronizeRequest& request, const farm::QuarantineEntry& entry) {
  return {ErrorCode::kFailedPrecondition,
          fmt::format("worker {} is quarantined: {} (the coordinator's log says more). Check the machine and "
                      "its memory; then let an administrator call 'tessera quarantine lift {:.12}'",
                      request.name(), entry.because, entry.producer.worker.value)};
}

core::Error not_compatible(const v1::SynchronizeRequest& request, const std::set<std::string>& accepted) {
  return {
      ErrorCode::kFailedPrecondition,
      fmt::format(
          "worker {} (release {}) is not bit-compatible with this farm: its fingerprint is {}, the farm's is "
          "{}. Install the coordinator's release on it; or, for a farm of that release's workers, start the "
          "coordinator with --accept-fingerprint {}",
          core::printable(request.name()), core::printable(request.version()),
          core::printable(request.determinism_fingerprint()), fmt::join(accepted, " or "),
          core::printable(request.determinism_fingerprint()))};
}

// Also if its leases were not revoked with those of the worker for which its principal is quarantined.
core::Status expect_trusted(StateLock& lock, const v1::SynchronizeRequest& request,
                            const scheduler::WorkerInfo& caller, bool is_registered) {
  const farm::QuarantineEntry* const entry =
      lock->quarantine.find(scheduler::producer_of(caller), is_registered);
  if (entry == nullptr) return {};
  core::Error error = quarantined(request, *entry);
  if (is_registered) lock.handle(scheduler::Dismiss{caller.id});
  return core::fail(std::move(error));
}

core::Status admit(StateLock& lock, const v1::SynchronizeRequest& request,
                   const scheduler::WorkerInfo& caller, const farm::SynchronizeCaller& call) {
  if (call.is_gone()) return core::fail(ErrorCode::kCancelled, "the caller has gone");
  if (lock->closed) return core::fail(ErrorCode::kUnavailable, "the coordinator is stopping: try again");
  const scheduler::WorkerInfo* const known = lock->scheduler.worker_info(caller.id);
  if (auto own = expect_own(known, caller.principal); !own) return own;
  if (auto trusted = expect_trusted(lock, request, caller, known != nullptr); !trusted) return trusted;
  const std::set<std::string>& accepted = lock.options().fingerprints;
  if (accepted.contains(request.determinism_fingerprint())) return {};
  core::Error error = not_compatible(request, accepted);
  lock.log_rejection(
      "refused: " + error.message,
      {.worker = request.worker_id(), .principal = caller.principal, .peer = call.principal.peer});
  return core::fail(std::move(error));
}

// Also those that have passed concern the job and the worker.
void note_troubles(StateLock& lock, const v1::SynchronizeRequest& request) {
  farm::Troubles& troubles = lock->troubles;
  const std::set<std::string> before = troubles.jobs_of_worker(request.worker_id());
  for (std::string& sentence : troubles.note(request))
    lock.log_trouble(std::move(sentence), lock.fields_of_worker(request.worker_id()));
  const std::set<std::string> after = troubles.jobs_of_worker(request.worker_id());
  if (before.empty() && after.empty()) return;
  lock.note_worker(request.worker_id());
  for (const auto* const jobs : {&before, &after})
    for (const std::string& job : *jobs)
      if (JobRecord* const record = lock->find_job(job)) lock.note_progress(*record);
}

// Of a worker that the scheduler knows.
void note_peer(StateLock& lock, const v1::SynchronizeRequest& request, const std::string& peer) {
  std::string& known = lock->peers[request.worker_id()];
  if (known != peer) known = peer;
}

// Of a worker that the scheduler knows.
void note_cache(StateLock& lock, const v1::SynchronizeRequest& request) {
  if (!request.has_cache()) return;
  const farm::CacheUse now{request.cache().used_bytes(), request.cache().limit_bytes()};
  const auto [known, is_new] = lock->caches.try_emplace(request.worker_id(), now);
  if (!is_new && std::exchange(known->second, now) == now) return;
  lock.note_worker(request.worker_id());
}

// Of a worker that the scheduler does not know: it was asked to drain before the coordinator was restarted.
std::optional<farm::Drain> drain_of_earlier_run(const StateLock& lock, const std::string& worker) {
  const farm::Drain* const drain = lock->drains.find(worker);
  if (drain == nullptr || lock->scheduler.worker_info({worker}) != nullptr) return std::nullopt;
  return *drain;
}

scheduler::Synchronize event_of(const StateLock& lock, const v1::SynchronizeRequest& request,
                                scheduler::WorkerInfo info, const std::vector<const v1::Lease*>& held,
                                const std::set<std::string>& fetching) {
  scheduler::Synchronize event{std::move(info),
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

// What the scheduler and the waiting calls have of the worker must agree. Memory as for results: see
// Dispatcher::decide().
void decide_leases(StateLock& lock, const v1::SynchronizeRequest& request,
                   const scheduler::Synchronize& event, farm::SynchronizeCaller caller,
                   std::set<std::string> known_jobs) noexcept {
  note_troubles(lock, request);
  const scheduler::Actions actions = lock->scheduler.handle(event, lock.now());
  if (!actions.status) {
    lock.apply(actions);
    return farm::refuse(lock, std::move(caller), actions.status.error());
  }
  note_peer(lock, request, caller.principal.peer);
  note_cache(lock, request);
  const scheduler::Reply& reply = *actions.reply;
  farm::WaitingCall call{std::move(caller), std::move(known_jobs),
                         lock.now() + reply.heartbeat_timeout / kCallsPerLease};
  const bool lacks_spec = std::any_of(reply.leases.begin(), reply.leases.end(), [&](const auto& lease) {
    return call.known_jobs.count(lease.job.value) == 0;
  });
  const bool nothing_left = request.draining() && reply.leases.empty();
  farm::answer(lock, request.worker_id(), reply);  // an earlier call of this worker
  lock->waiting.add(request.worker_id(), std::move(call));
  if (reply.changed || lacks_spec || nothing_left) farm::answer(lock, request.worker_id(), reply);
  lock.apply(actions);
}

}  // namespace

void Dispatcher::synchronize(const v1::SynchronizeRequest& request, farm::SynchronizeCaller caller) {
  const core::Status valid = check_request(request);
  const std::vector<const v1::Lease*> held = held_leases(request);
  const std::set<std::string> fetching = first_ids(request.fetching_job_ids(), kMaxFetchingJobs);
  std::set<std::string> known_jobs = first_ids(request.known_job_ids(), kMaxKnownJobs);
  scheduler::WorkerInfo info = info_of(request, caller.principal);
  StateLock lock(farm_);
  const core::Status possible = valid ? lock.expect_memory() : valid;
  const core::Status admitted = possible ? admit(lock, request, info, caller) : possible;
  if (!admitted) return farm::refuse(lock, std::move(caller), admitted.error());

  scheduler::Synchronize event = event_of(lock, request, std::move(info), held, fetching);
  const std::optional<farm::Drain> drain = drain_of_earlier_run(lock, request.worker_id());
  event.draining |= drain.has_value();
  decide_leases(lock, request, event, std::move(caller), std::move(known_jobs));
  if (drain) lock.handle(scheduler::Drain{{request.worker_id()}, true, drain->stop});
}

}  // namespace tessera::dispatch
