// SPDX-License-Identifier: Apache-2.0
// The coordinator's side of SubmitResult: results of workers are checked and counted.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "core/base/printable.hpp"
#include "proto/text.hpp"
#include "proto/tile_codec.hpp"
#include "server/coordinator/plausible.hpp"
#include "server/coordinator/state_lock.hpp"
#include "server/coordinator/wire.hpp"

namespace tessera::coordinator {

using core::ErrorCode;

namespace {

// A message of some kilobytes could otherwise take gigabytes to decompress.
constexpr int kMaxItemsPerResult = 256;

// The bound on a reason that a worker gives.
constexpr std::size_t kMaxReasonBytes = 500;

// Allocates what film->add() needs before the scheduler counts samples as done.
void reserve_film(JobRecord& record, const scheduler::SubmitResult& event,
                  const std::vector<core::FilmTile>& tiles) {
  for (std::size_t i = 0; record.film && i < tiles.size(); ++i)
    if (event.items[i].tile != scheduler::kNoTile) record.film->reserve(tiles[i]);
}

core::Status check_texts(const v1::SubmitResultRequest& request) {
  if (auto fit = proto::check_text("version", request.version()); !fit) return fit;
  return proto::check_text("determinism_fingerprint", request.determinism_fingerprint());
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
      fmt::format("these samples (release {}, fingerprint {}) are not bit-compatible with job {} "
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
