// SPDX-License-Identifier: Apache-2.0
// The coordinator's side of SubmitResult: results of workers are checked and counted.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "core/base/printable.hpp"
#include "proto/text.hpp"
#include "proto/tile_codec.hpp"
#include "server/dispatch/caller.hpp"
#include "server/dispatch/dispatcher.hpp"
#include "server/farm/troubles.hpp"
#include "server/farm/wire.hpp"
#include "server/film/plausible.hpp"
#include "server/scheduler/item_text.hpp"

namespace tessera::dispatch {

using core::ErrorCode;
using farm::JobRecord;
using farm::StateLock;

namespace {

// A message of some kilobytes could otherwise take gigabytes to decompress.
constexpr int kMaxItemsPerResult = 256;
constexpr std::uint64_t kMaxWordBytesPerResult = std::uint64_t{64} << 20;

// Checkpoints follow each other at once while memory is scarce.
constexpr std::uint32_t kDeferredMs = 1000;

// The bound on a reason that a worker gives.
constexpr std::size_t kMaxReasonBytes = 500;

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

core::Status check_size(const v1::SubmitResultRequest& request) {
  if (request.items_size() > kMaxItemsPerResult) {
    return core::fail(ErrorCode::kInvalidArgument, fmt::format("items: at most {} in one message, got {}",
                                                               kMaxItemsPerResult, request.items_size()));
  }
  std::uint64_t bytes = 0;
  for (const v1::RenderedItem& item : request.items()) bytes += proto::claimed_bytes(item);
  if (bytes > kMaxWordBytesPerResult)
    return core::fail(ErrorCode::kInvalidArgument,
                      fmt::format("items: at most {} MiB of words in one message, got {} bytes",
                                  kMaxWordBytesPerResult >> 20, bytes));
  return {};
}

bool has_planes(const v1::SubmitResultRequest& request) {
  return std::any_of(request.items().begin(), request.items().end(),
                     [](const v1::RenderedItem& item) { return !item.plane_words().empty(); });
}

core::Result<film::Notes> decode_items(const v1::SubmitResultRequest& request, core::LayerSet layers) {
  if (auto fits = check_size(request); !fits) return core::fail(fits.error());
  film::Notes tiles;
  for (int i = 0; i < request.items_size(); ++i) {
    auto tile = proto::decode_tile(request.items(i), layers);
    core::Status valid = tile ? film::check_plausible(*tile) : core::fail(tile.error());
    if (!valid) return core::fail(valid.error().within(fmt::format("items[{}]", i)));
    tiles.push_back({scheduler::kNoTile, std::move(*tile)});
  }
  return tiles;
}

scheduler::SubmitResult event_of(const v1::SubmitResultRequest& request, const scheduler::JobGrid& grid,
                                 const film::Notes& tiles,
                                 const std::vector<scheduler::Fingerprint>& fingerprints,
                                 std::string determinism_fingerprint) {
  scheduler::SubmitResult event{{request.worker_id()},
                                {request.job_id()},
                                {request.lease_id()},
                                {},
                                farm::seconds(request.render_time()),
                                request.lease_finished(),
                                farm::excerpt(request.decline_reason(), kMaxReasonBytes),
                                fingerprints,
                                held_besides(request),
                                request.lease_token(),
                                std::move(determinism_fingerprint)};
  auto item = request.items().begin();
  for (const film::Note& tile : tiles) {
    const std::uint32_t image = item++->item().image();
    event.items.push_back({grid.find(image, tile.samples.rect), tile.samples.range});
  }
  return event;
}

// Must run before the accepted items of the same result are noted.
void clear_dropped_tiles(StateLock& lock, const scheduler::Actions& actions, film::Notes& spare) {
  for (const scheduler::TileOfJob& dropped : actions.dropped_tiles) {
    film::JobFilm& film = *lock->find_job(dropped.job.value)->film;
    lock.log(spdlog::level::warn,
             fmt::format("{} of job {} is rendered again: some of it was wrong",
                         scheduler::describe_tile(film.grid(), dropped.tile), dropped.job.value),
             {.job = dropped.job.value});
    film.note_clear(dropped.tile, spare);
  }
}

// The leases that the worker should hold besides those that it has named.
farm::LeaseMessages new_leases(const StateLock& lock, const scheduler::SubmitResult& event,
                               scheduler::Reply reply) {
  std::erase_if(reply.leases, [&](const scheduler::LeaseDescription& lease) {
    return std::find(event.held.begin(), event.held.end(), lease.id) != event.held.end();
  });
  static const std::set<std::string> kNone;
  const farm::WaitingCall* const call = lock->waiting.find(event.worker.value);
  return {lock, std::move(reply), call == nullptr ? kNone : call->known_jobs};
}

// The fingerprint of the worker that rendered the result. Empty if it neither says so nor is registered, and
// the farm accepts several.
std::string fingerprint_of(const StateLock& lock, const v1::SubmitResultRequest& request) {
  if (!request.determinism_fingerprint().empty()) return request.determinism_fingerprint();
  if (const auto* const info = lock->scheduler.worker_info({request.worker_id()}))
    return info->determinism_fingerprint;
  const std::set<std::string>& accepted = lock.options().fingerprints;
  return accepted.size() == 1 ? *accepted.begin() : "";
}

// Who delivers, for the log: as the caller says, which nothing proves.
common::LogFields fields_of(const v1::SubmitResultRequest& request, const farm::WorkerPrincipal& caller) {
  constexpr std::size_t kIdBytes = 32;
  return {.job = farm::excerpt(request.job_id(), kIdBytes),
          .worker = farm::excerpt(request.worker_id(), kIdBytes),
          .principal = caller.name,
          .peer = caller.peer};
}

core::Status may_count(StateLock& lock, const JobRecord& record, const v1::SubmitResultRequest& request,
                       const farm::WorkerPrincipal& caller, const std::string& offered) {
  const std::set<std::string>& accepted = lock.options().fingerprints;
  const bool fits = record.arithmetic.empty() ? accepted.contains(offered) : offered == record.arithmetic;
  if (fits) return {};
  const std::string expected =
      record.arithmetic.empty() ? fmt::format("{}", fmt::join(accepted, " or ")) : record.arithmetic;
  lock.log_rejection(
      fmt::format("rejected a result of worker {:.32} for job {}: its fingerprint is {}, the job's {}",
                  request.worker_id(), record.spec->id(), offered, expected),
      fields_of(request, caller));
  return core::fail(
      ErrorCode::kFailedPrecondition,
      fmt::format("these samples (release {}, fingerprint {}) are not bit-compatible with job {} "
                  "(fingerprint {}), and do not count",
                  request.version(), offered, record.spec->id(), expected));
}

void note_rejected_result(StateLock& lock, const v1::SubmitResultRequest& request,
                          const farm::WorkerPrincipal& caller, const core::Error& error) {
  const std::string& worker = request.worker_id();
  const scheduler::WorkerInfo* const known = lock->scheduler.worker_info({worker});
  if (known == nullptr) {
    return lock.log_rejection(
        fmt::format("rejected a result of worker {:.32}, which has not registered since the coordinator "
                    "was started: {}",
                    worker, error.message),
        fields_of(request, caller));
  }
  lock.log_rejection(
      fmt::format("rejected a result of worker {} ({}): {}", known->name, worker, error.message),
      fields_of(request, caller));
  const bool is_last = lock->quarantine.refused(worker);
  lock.note_worker(worker);
  if (!is_last) return;
  lock.quarantine(scheduler::producer_of(*known), fmt::format("{} of its results in a row were rejected",
                                                              farm::Quarantine::kRejectionsUntilQuarantine));
  lock.handle(scheduler::Dismiss{{worker}, true});
}

// PERMISSION_DENIED or FAILED_PRECONDITION if this caller may not deliver results of the worker.
core::Status may_deliver(const StateLock& lock, const std::string& worker,
                         const farm::WorkerPrincipal& caller) {
  const scheduler::WorkerInfo* const known = lock->scheduler.worker_info({worker});
  if (auto own = expect_own(known, caller.name); !own) return own;
  const std::string principal = caller.individual ? caller.name : "";
  const scheduler::Producer producer =
      known != nullptr ? scheduler::producer_of(*known) : scheduler::Producer{{}, {worker}, {}, principal};
  const farm::QuarantineEntry* const entry = lock->quarantine.find(producer, known != nullptr);
  if (entry == nullptr) return {};
  return core::fail(ErrorCode::kFailedPrecondition,
                    fmt::format("this worker is quarantined: {}", entry->because));
}

}  // namespace

// The decoded content of a result, prepared without the state lock.
struct Dispatcher::Delivery {
  film::Notes tiles;
  core::LayerSet layers{};  // of the tiles
  std::vector<scheduler::Fingerprint> fingerprints;
  // Memory for notes to clear tiles: an item can disprove one tile.
  film::Notes spare{};
  farm::WorkerPrincipal caller{};
};

// What became of a result. The answer is made of it without the state lock.
struct Dispatcher::Counted {
  std::uint32_t accepted_items = 0, dropped_items = 0;
  // The leases that the worker should hold besides those that it has named.
  std::optional<farm::LeaseMessages> new_leases;
  // The film that samples were noted for; null once the job is stored.
  std::shared_ptr<film::JobFilm> film;

  v1::SubmitResultResponse message() const;
};

v1::SubmitResultResponse Dispatcher::Counted::message() const {
  v1::SubmitResultResponse response;
  response.set_accepted_items(accepted_items);
  response.set_dropped_items(dropped_items);
  if (!new_leases || new_leases->empty()) return response;
  v1::SynchronizeResponse leases = new_leases->build();
  response.mutable_new_leases()->Swap(leases.mutable_leases());
  response.mutable_jobs()->Swap(leases.mutable_jobs());
  return response;
}

// A caller that cannot prove that the lease was granted to the named worker may be anybody: its result does
// not count against the worker.
core::Status Dispatcher::check_token(const v1::SubmitResultRequest& request,
                                     const farm::WorkerPrincipal& caller) {
  const scheduler::LeaseToken token =
      signer_.sign({request.lease_id()}, {request.worker_id()}, {request.job_id()});
  if (request.lease_token() == token) return {};
  StateLock(farm_).log_rejection(
      fmt::format("rejected a result of job {:.32}: its token does not prove that lease {} was given to "
                  "worker {:.32}, which it names",
                  core::printable(request.job_id()), request.lease_id(),
                  core::printable(request.worker_id())),
      fields_of(request, caller));
  return core::fail(
      ErrorCode::kInvalidArgument,
      fmt::format("lease_token: does not prove that lease {} of this job was given to this worker by "
                  "this farm. Send the token that came with the lease",
                  request.lease_id()));
}

core::Result<v1::SubmitResultResponse> Dispatcher::submit_result(const v1::SubmitResultRequest& request,
                                                                 const farm::WorkerPrincipal& caller) {
  if (auto fit = check_texts(request); !fit)
    return core::fail(rejected(RejectedFor::kMalformed, fit.error()));
  if (auto own = check_token(request, caller); !own)
    return core::fail(rejected(RejectedFor::kToken, own.error()));
  if (request.items_size() > 0 && !film_memory_.has_room()) return core::fail(defer(request, caller));
  const std::optional<core::LayerSet> layers = layers_of_job(request.job_id());
  if (!layers && has_planes(request)) return drop(request, caller);
  Delivery delivery;
  delivery.layers = layers.value_or(core::LayerSet());
  auto tiles = decode_items(request, delivery.layers);
  if (tiles) delivery.tiles = std::move(*tiles);
  for (const film::Note& tile : delivery.tiles)
    delivery.fingerprints.push_back(fingerprinter_.of(tile.samples));
  delivery.spare.resize(delivery.tiles.size());
  delivery.caller = caller;
  const core::Result<Counted> counted = [&]() -> core::Result<Counted> {
    StateLock lock(farm_);
    if (auto enough = lock.expect_memory(); !enough)
      return core::fail(rejected(RejectedFor::kMemory, enough.error()));
    if (auto may = may_deliver(lock, request.worker_id(), caller); !may)
      return core::fail(refuse(may.error()));
    auto result = tiles ? count_result(lock, request, delivery)
                        : core::Result<Counted>(core::fail(rejected(RejectedFor::kMalformed, tiles.error())));
    if (!result && result.error().code == ErrorCode::kInvalidArgument)
      note_rejected_result(lock, request, caller, result.error());
    if (result && request.items_size() > 0) lock->quarantine.in_order(request.worker_id());
    return result;
  }();
  if (!counted) return core::fail(counted.error());
  if (counted->film) counted->film->apply();
  return counted->message();
}

// Empty if the job has no film in memory.
std::optional<core::LayerSet> Dispatcher::layers_of_job(const std::string& id) {
  const StateLock lock(farm_);
  const JobRecord* const record = lock->find_job(id);
  if (record == nullptr || !record->film) return std::nullopt;
  return record->film->layers();
}

// A result with layers of a job that is gone, that is done and stored, or that could not be recovered. It is
// not decoded: nobody knows which layers these are.
core::Result<v1::SubmitResultResponse> Dispatcher::drop(const v1::SubmitResultRequest& request,
                                                        const farm::WorkerPrincipal& caller) {
  if (auto fits = check_size(request); !fits)
    return core::fail(rejected(RejectedFor::kMalformed, fits.error()));
  {
    StateLock lock(farm_);
    if (auto may = may_deliver(lock, request.worker_id(), caller); !may)
      return core::fail(refuse(may.error()));
  }
  const auto items = static_cast<std::uint32_t>(request.items_size());
  result_counts_.note_items_of_unknown_job(items);
  v1::SubmitResultResponse response;
  response.set_dropped_items(items);
  return response;
}

core::Error Dispatcher::refuse(const core::Error& error) {
  const bool is_own = error.code != ErrorCode::kPermissionDenied;
  return rejected(is_own ? RejectedFor::kQuarantine : RejectedFor::kPrincipal, error);
}

// The worker keeps its leases meanwhile.
core::Error Dispatcher::defer(const v1::SubmitResultRequest& request, const farm::WorkerPrincipal& caller) {
  {
    StateLock lock(farm_);
    if (may_deliver(lock, request.worker_id(), caller))
      lock.handle(scheduler::DeferResult{{request.worker_id()}, {request.lease_id()}});
  }
  const core::Error later{ErrorCode::kUnavailable,
                          "the memory for films is used up until a checkpoint is written "
                          "(tessera-coordinator --max-film-gib): deliver again"};
  return rejected(RejectedFor::kFilmMemory,
                  later.with({.option = "--max-film-gib", .retry_delay_ms = kDeferredMs}));
}

core::Result<Dispatcher::Counted> Dispatcher::count_result(StateLock& lock,
                                                           const v1::SubmitResultRequest& request,
                                                           Delivery& delivery) {
  JobRecord* record = lock->find_job(request.job_id());
  // A job that was brought back meanwhile may have other layers.
  if (record == nullptr || (record->film && record->film->layers() != delivery.layers)) {
    result_counts_.note_items_of_unknown_job(delivery.tiles.size());
    return Counted{0, static_cast<std::uint32_t>(delivery.tiles.size()), {}, {}};
  }
  const std::string offered = fingerprint_of(lock, request);
  if (auto may = may_count(lock, *record, request, delivery.caller, offered); !may)
    return core::fail(rejected(RejectedFor::kFingerprint, may.error()));
  scheduler::SubmitResult event =
      event_of(request, farm::grid_of(*record->spec), delivery.tiles, delivery.fingerprints, offered);
  if (delivery.caller.individual) event.principal = delivery.caller.name;
  return decide(lock, *record, event, delivery);
}

// The scheduler and the film must agree. What is allocated here is less than the memory reserve, also with
// the offers to other workers that follow. If that is not enough, the process ends, and the next start
// continues from the store.
core::Result<Dispatcher::Counted> Dispatcher::decide(StateLock& lock, JobRecord& record,
                                                     const scheduler::SubmitResult& event,
                                                     Delivery& delivery) noexcept {
  const scheduler::Actions actions = lock->scheduler.handle(event, lock.now());
  if (!actions.status) {
    lock.apply(actions);
    return core::fail(rejected(RejectedFor::kLease, actions.status.error()));
  }
  Counted counted;
  counted.film = record.film;
  clear_dropped_tiles(lock, actions, delivery.spare);
  auto tile = delivery.tiles.begin();
  for (std::size_t i = 0; i < event.items.size(); ++i) {
    const auto item = tile++;
    item->tile = event.items[i].tile;
    if (actions.verdicts[i] == scheduler::Verdict::kAccepted)
      record.film->note_addition(delivery.tiles, item);
    // A worker is not told whether its samples were accepted or audited.
    ++(actions.verdicts[i] == scheduler::Verdict::kDropped ? counted.dropped_items : counted.accepted_items);
  }
  if (counted.accepted_items > 0 && record.arithmetic.empty()) {
    record.arithmetic = event.determinism_fingerprint;
    lock.note_first_samples(record);
    lock.change(record);
  }
  if (actions.reply) counted.new_leases = new_leases(lock, event, *actions.reply);
  lock.apply(actions);
  return counted;
}

}  // namespace tessera::dispatch
