// SPDX-License-Identifier: Apache-2.0
// The list of workers.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <utility>

#include "proto/state_text.hpp"
#include "server/base/wall_clock.hpp"
#include "server/dispatch/caller.hpp"
#include "server/dispatch/dispatcher.hpp"
#include "server/farm/pages.hpp"
#include "server/farm/wire.hpp"

namespace tessera::dispatch {

using core::ErrorCode;

using farm::StateLock;

namespace {

// Workers that are copied in one hold of the state lock, which takes about a microsecond for each.
constexpr std::size_t kWorkersAtOnce = 64;

// What a worker's entry is made of, copied under the state lock.
struct WorkerSnapshot {
  scheduler::WorkerView view;
  std::uint64_t rejected_results = 0;
  std::vector<std::string> troubles;
  std::string quarantined_because;  // empty unless it is quarantined
  std::optional<farm::CacheUse> cache{};
};

WorkerSnapshot snapshot_of(const StateLock& lock, scheduler::WorkerView view) {
  const scheduler::WorkerInfo& info = view.info;
  const std::string& id = info.id.value;
  WorkerSnapshot snapshot{{}, lock->quarantine.refusals(id), lock->troubles.of_worker(id), {}};
  if (const farm::QuarantineEntry* const entry = lock->quarantine.find(scheduler::producer_of(info), true))
    snapshot.quarantined_because = entry->because;
  if (const auto cache = lock->caches.find(id); cache != lock->caches.end()) snapshot.cache = cache->second;
  snapshot.view = std::move(view);
  return snapshot;
}

v1::Worker to_wire(const WorkerSnapshot& snapshot, scheduler::Time now) {
  const auto silent = std::chrono::duration_cast<std::chrono::milliseconds>(now - snapshot.view.last_seen);
  auto worker = farm::to_wire(snapshot.view, base::wall_clock_ms() - silent.count());
  worker.set_rejected_results(snapshot.rejected_results);
  worker.mutable_troubles()->Add(snapshot.troubles.begin(), snapshot.troubles.end());
  if (snapshot.cache) {
    worker.mutable_cache()->set_used_bytes(snapshot.cache->used_bytes);
    worker.mutable_cache()->set_limit_bytes(snapshot.cache->limit_bytes);
  }
  if (snapshot.quarantined_because.empty()) return worker;
  worker.set_quarantined(true);
  worker.set_quarantine_reason(snapshot.quarantined_because);
  return worker;
}

core::Status check_filters(const v1::ListWorkersRequest& request) {
  if (!request.page_token().empty() && !is_worker_id(request.page_token()))
    return core::fail(ErrorCode::kInvalidArgument, "page_token: is not that of an earlier response");
  for (const int state : request.states())
    if (state <= v1::WORKER_STATE_UNSPECIFIED || !v1::WorkerState_IsValid(state))
      return core::fail(ErrorCode::kInvalidArgument,
                        fmt::format("states: must be of WorkerState, got {}", state));
  return {};
}

bool matches(const v1::Worker& worker, const v1::ListWorkersRequest& request) {
  const std::string& prefix = request.prefix();
  if (!worker.id().starts_with(prefix) && !worker.name().starts_with(prefix)) return false;
  if (request.has_principal() && worker.principal() != request.principal()) return false;
  const std::int64_t seen_ms = farm::ms_from_timestamp(worker.last_seen_at());
  if (request.has_seen_from() && seen_ms < farm::ms_from_timestamp(request.seen_from())) return false;
  if (request.has_seen_before() && seen_ms >= farm::ms_from_timestamp(request.seen_before())) return false;
  const int state = proto::state_of(worker);
  return request.states().empty() ||
         std::find(request.states().begin(), request.states().end(), state) != request.states().end();
}

}  // namespace

std::optional<v1::Worker> Dispatcher::worker(const std::string& id) {
  std::optional<WorkerSnapshot> snapshot;
  scheduler::Time now;
  {
    const StateLock lock(farm_);
    now = lock.now();
    auto view = lock->scheduler.worker({id}, now);
    if (view) snapshot = snapshot_of(lock, std::move(*view));
  }
  if (!snapshot) return std::nullopt;
  return to_wire(*snapshot, now);
}

std::vector<v1::Worker> Dispatcher::next_workers(const std::string& after) {
  std::vector<WorkerSnapshot> snapshots;
  scheduler::Time now;
  {
    const StateLock lock(farm_);
    now = lock.now();
    for (scheduler::WorkerView& view : lock->scheduler.workers(now, {after}, kWorkersAtOnce))
      snapshots.push_back(snapshot_of(lock, std::move(view)));
  }
  std::vector<v1::Worker> result;
  for (const WorkerSnapshot& snapshot : snapshots) result.push_back(to_wire(snapshot, now));
  return result;
}

std::vector<v1::Worker> Dispatcher::workers() {
  std::vector<v1::Worker> all;
  for (auto next = next_workers(""); !next.empty(); next = next_workers(all.back().id()))
    std::move(next.begin(), next.end(), std::back_inserter(all));
  return all;
}

// The token of the next page is the last id of this one.
core::Result<v1::ListWorkersResponse> Dispatcher::list_workers(const v1::ListWorkersRequest& request) {
  if (auto fine = check_filters(request); !fine) return core::fail(fine.error());
  const int most = farm::page_size(request.page_size());
  v1::ListWorkersResponse page;
  std::string after = request.page_token();
  for (auto next = next_workers(after); !next.empty(); next = next_workers(after)) {
    for (v1::Worker& worker : next) {
      const std::string id = worker.id();
      const bool is_wanted = matches(worker, request);
      if (is_wanted && page.workers_size() == most) {
        page.set_next_page_token(after);
        return page;
      }
      if (is_wanted) *page.add_workers() = std::move(worker);
      after = id;
    }
  }
  return page;
}

}  // namespace tessera::dispatch
