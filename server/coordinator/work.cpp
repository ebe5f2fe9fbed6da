// SPDX-License-Identifier: Apache-2.0
// The workers' methods of the coordinator.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "core/base/printable.hpp"
#include "proto/text.hpp"
#include "proto/tile_codec.hpp"
#include "proto/worker_key.hpp"
#include "server/coordinator/plausible.hpp"
#include "server/coordinator/state_lock.hpp"
#include "server/coordinator/wire.hpp"

namespace tessera::coordinator {

using core::ErrorCode;

namespace {

// Waiting calls are answered three times per heartbeat timeout.
constexpr int kCallsPerLease = 3;

// A message of some kilobytes could otherwise take gigabytes to decompress.
constexpr int kMaxItemsPerResult = 256;

// The bound on a reason that a worker gives.
constexpr std::size_t kMaxReasonBytes = 500;

bool is_id(const std::string& text) {
  return text.size() == 32 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

// Allocates what film->add() needs before the scheduler counts samples as done.
void reserve_film(JobRecord& record, const scheduler::SubmitResult& event,
                  const std::vector<core::FilmTile>& tiles) {
  for (std::size_t i = 0; record.film && i < tiles.size(); ++i)
    if (event.items[i].tile != scheduler::kNoTile) record.film->reserve(tiles[i]);
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

core::Status check_texts(const v1::SubmitResultRequest& request) {
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

// Leases beyond what a worker can hold are ignored.
std::vector<scheduler::LeaseId> held_besides(const v1::SubmitResultRequest& request) {
  std::vector<scheduler::LeaseId> held;
  for (const std::uint64_t id : request.held_lease_ids()) {
    if (held.size() > scheduler::kMaxLeasesPerWorker) break;
    held.push_back({id});
  }
  return held;
}

core::Result<std::vector<core::FilmTile>> decode_items(const v1::SubmitResultRequest& request) {
  if (request.items_size() > kMaxItemsPerResult) {
    return core::fail(ErrorCode::kInvalidArgument, fmt::format("items: at most {} in one message, got {}",
                                                               kMaxItemsPerResult, request.items_size()));
  }
  std::vector<core::FilmTile> tiles;
  for (int i = 0; i < request.items_size(); ++i) {
    auto tile = proto::decode_tile(request.items(i));
    core::Status valid = tile ? check_plausible(*tile) : core::fail(tile.error());
    if (!valid) return core::fail(valid.error().within(fmt::format("items[{}]", i)));
    tiles.push_back(std::move(*tile));
  }
  return tiles;
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
          "worker {} (release {}) computes other bits than this farm: its fingerprint is {}, the farm's is "
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

void Coordinator::tell_with_answer(const scheduler::SubmitResult& event, scheduler::Reply reply,
                                   v1::SubmitResultResponse& response) {
  std::erase_if(reply.leases, [&](const scheduler::LeaseDescription& lease) {
    return std::find(event.held.begin(), event.held.end(), lease.id) != event.held.end();
  });
  if (reply.leases.empty()) return;
  static const std::set<std::string> kNone;
  const auto call = parked_.find(event.worker.value);
  auto news = respond(reply, call == parked_.end() ? kNone : call->second.known_jobs);
  response.mutable_new_leases()->Swap(news.mutable_leases());
  response.mutable_jobs()->Swap(news.mutable_jobs());
}

// The decoded content of a result, prepared without the state lock.
struct Coordinator::Delivery {
  std::vector<core::FilmTile> tiles;
  std::vector<scheduler::Fingerprint> fingerprints;
};

// A caller that cannot prove that the lease was granted to the named worker may be anybody: its result does
// not count against the worker.
core::Status Coordinator::check_token(const v1::SubmitResultRequest& request) {
  const scheduler::LeaseToken token =
      signer_.sign({request.lease_id()}, {request.worker_id()}, {request.job_id()});
  if (request.lease_token() == token) return {};
  StateLock lock(*this);
  rejected_log_.warn(
      fmt::format("rejected a result of job {:.32}: its token does not prove that lease {} was given to "
                  "worker {:.32}, which it names",
                  core::printable(request.job_id()), request.lease_id(),
                  core::printable(request.worker_id())),
      lock.now());
  return core::fail(
      ErrorCode::kInvalidArgument,
      fmt::format("lease_token: does not prove that lease {} of this job was given to this worker by "
                  "this farm. Send the token that came with the lease",
                  request.lease_id()));
}

core::Result<v1::SubmitResultResponse> Coordinator::submit_result(const v1::SubmitResultRequest& request) {
  if (auto fit = check_texts(request); !fit) return core::fail(fit.error());
  if (auto own = check_token(request); !own) return core::fail(own.error());
  auto tiles = decode_items(request);
  Delivery delivery;
  if (tiles) delivery.tiles = std::move(*tiles);
  for (const core::FilmTile& tile : delivery.tiles) delivery.fingerprints.push_back(fingerprinter_.of(tile));
  StateLock lock(*this);
  if (quarantine_.is_quarantined(request.worker_id())) {
    return core::fail(
        ErrorCode::kFailedPrecondition,
        fmt::format("this worker is quarantined: {}", quarantine_.because(request.worker_id(), "")));
  }
  auto counted = tiles ? count_result(lock, request, delivery)
                       : core::Result<v1::SubmitResultResponse>(core::fail(tiles.error()));
  if (!counted && counted.error().code == ErrorCode::kInvalidArgument) {
    note_rejected_result(lock, request.worker_id(), counted.error());
  } else if (counted && request.items_size() > 0) {
    quarantine_.in_order(request.worker_id());
  }
  return counted;
}

core::Result<v1::SubmitResultResponse> Coordinator::count_result(StateLock& lock,
                                                                 const v1::SubmitResultRequest& request,
                                                                 const Delivery& delivery) {
  v1::SubmitResultResponse response;
  JobRecord* record = find(request.job_id());
  if (record == nullptr) {
    response.set_dropped_items(static_cast<std::uint32_t>(delivery.tiles.size()));
    return response;
  }
  if (auto may = may_count(lock, *record, request); !may) return core::fail(may.error());
  const core::TileGrid grid = grid_of(*record->spec);
  scheduler::SubmitResult event{{request.worker_id()},
                                {request.job_id()},
                                {request.lease_id()},
                                {},
                                seconds(request.render_time()),
                                request.lease_finished(),
                                excerpt(request.decline_reason(), kMaxReasonBytes),
                                delivery.fingerprints,
                                held_besides(request),
                                request.lease_token()};
  for (const core::FilmTile& tile : delivery.tiles)
    event.items.push_back({scheduler::tile_index(grid, tile.rect), tile.range});
  reserve_film(*record, event, delivery.tiles);
  const scheduler::Actions actions = scheduler_.handle(event, lock.now());
  if (!actions.status) {
    apply(lock, actions);
    return core::fail(actions.status.error());
  }

  empty_tiles(actions);
  for (std::size_t i = 0; i < delivery.tiles.size(); ++i) {
    if (actions.verdicts[i] == scheduler::Verdict::kAccepted)
      record->film->add(event.items[i].tile, delivery.tiles[i]);
    // A worker is not told whether its samples were accepted or audited.
    if (actions.verdicts[i] == scheduler::Verdict::kDropped) {
      response.set_dropped_items(response.dropped_items() + 1);
    } else {
      response.set_accepted_items(response.accepted_items() + 1);
    }
  }
  if (response.accepted_items() > 0 && record->arithmetic.empty()) {
    record->arithmetic = options_.fingerprint;
    ++record->revision;
  }
  if (actions.reply) tell_with_answer(event, *actions.reply, response);
  apply(lock, actions);
  return response;
}

core::Status Coordinator::may_count(const StateLock& lock, const JobRecord& record,
                                    const v1::SubmitResultRequest& request) {
  const std::string& expected = record.arithmetic.empty() ? options_.fingerprint : record.arithmetic;
  const std::string& offered =
      request.determinism_fingerprint().empty() ? options_.fingerprint : request.determinism_fingerprint();
  if (offered == expected) return {};
  rejected_log_.warn(
      fmt::format("rejected a result of worker {:.32} for job {}: its fingerprint is {}, the job's {}",
                  request.worker_id(), record.spec->id(), offered, expected),
      lock.now());
  return core::fail(
      ErrorCode::kFailedPrecondition,
      fmt::format("these samples are of another arithmetic (release {}, fingerprint {}) than job {} "
                  "(fingerprint {}), and do not count",
                  request.version(), offered, record.spec->id(), expected));
}

void Coordinator::note_rejected_result(StateLock& lock, const std::string& worker, const core::Error& error) {
  const auto workers = scheduler_.workers(lock.now());
  const auto known = std::find_if(workers.begin(), workers.end(), [&](const scheduler::WorkerView& each) {
    return each.info.id.value == worker;
  });
  if (known == workers.end()) {
    rejected_log_.warn(
        fmt::format("rejected a result of worker {:.32}, which has not registered since the coordinator "
                    "was started: {}",
                    worker, error.message),
        lock.now());
    return;
  }
  const std::string& name = known->info.name;
  const std::string& machine = known->info.machine;
  rejected_log_.warn(fmt::format("rejected a result of worker {} ({}): {}", name, worker, error.message),
                     lock.now());
  if (!quarantine_.refused(worker, machine)) return;
  spdlog::error("worker {} ({}) is quarantined: {}. What it rendered before is verified by others", name,
                worker, quarantine_.because(worker, machine));
  apply(lock, scheduler_.handle(scheduler::Dismiss{{worker}, true}, lock.now()));
}

}  // namespace tessera::coordinator
