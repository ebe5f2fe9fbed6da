// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/fleet.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "server/farm/state_lock.hpp"
#include "server/fleet/quarantine_codec.hpp"

namespace tessera::fleet {

using core::ErrorCode;
using farm::QuarantineEntry;
using farm::StateLock;

namespace {

// What is looked at in one hold of the state lock.
constexpr std::size_t kWorkersAtOnce = 64;

// The entries that have changed; empty where one was lifted.
using Changes = std::vector<std::pair<std::string, std::optional<QuarantineEntry>>>;

Changes take_changes(farm::Farm& farm) {
  StateLock lock(farm);
  Changes changes;
  const auto& entries = lock->quarantine.entries();
  for (const std::string& worker : lock->quarantine.take_changes()) {
    const auto entry = entries.find(worker);
    changes.emplace_back(
        worker, entry == entries.end() ? std::nullopt : std::optional<QuarantineEntry>(entry->second));
  }
  return changes;
}

}  // namespace

core::Status Fleet::restore() {
  const auto rows = store_.quarantine();
  if (!rows) return core::fail(rows.error());
  for (const store::QuarantineRow& row : *rows) {
    auto entry = row.intact ? decode(row.content) : std::nullopt;
    if (!entry) {
      spdlog::error("the stored quarantine of worker {} is damaged, and no longer applies", row.id);
      continue;
    }
    StateLock lock(farm_);
    lock.handle(scheduler::Distrust{entry->producer});
    lock->quarantine.add(std::move(*entry));
  }
  StateLock(farm_)->quarantine.take_changes();
  if (!rows->empty()) spdlog::info("{} workers are quarantined since an earlier run", rows->size());
  return {};
}

core::Status Fleet::save() {
  const std::lock_guard saving(saving_);
  const Changes changes = take_changes(farm_);
  std::set<std::string> left;
  core::Status saved;
  for (const auto& [worker, entry] : changes) {
    if (saved)
      saved = entry ? store_.write_quarantine(worker, encode(*entry)) : store_.delete_quarantine(worker);
    if (!saved) left.insert(worker);
  }
  if (!left.empty()) StateLock(farm_)->quarantine.return_changes(std::move(left));
  return saved;
}

v1::ListQuarantineResponse Fleet::quarantine() {
  std::vector<QuarantineEntry> entries;
  {
    const StateLock lock(farm_);
    for (const auto& [worker, entry] : lock->quarantine.entries()) entries.push_back(entry);
  }
  std::stable_sort(entries.begin(), entries.end(), [](const QuarantineEntry& a, const QuarantineEntry& b) {
    return a.since_ms < b.since_ms;
  });
  v1::ListQuarantineResponse response;
  for (const QuarantineEntry& entry : entries) *response.add_entries() = to_wire(entry);
  return response;
}

core::Status Fleet::lift(const std::string& id) {
  {
    StateLock lock(farm_);
    const std::vector<QuarantineEntry> lifted = lock->quarantine.lift(id);
    if (lifted.empty())
      return core::fail(
          ErrorCode::kNotFound,
          fmt::format("the quarantine has no entry {}: tessera quarantine lists those it has", id));
    for (const QuarantineEntry& entry : lifted) {
      lock.handle(scheduler::Trust{entry.producer});
      lock.note_worker(entry.producer.worker.value);
      lock.log(spdlog::level::info, fmt::format("the quarantine of worker {} ({}) is lifted",
                                                called(entry.producer), entry.producer.worker.value));
    }
  }
  return save();
}

// The id itself, or the only worker with this name or prefix of its id.
core::Result<std::string> Fleet::find_worker(const std::string& id_or_name) {
  std::vector<std::string> matches;
  std::string after;
  while (!id_or_name.empty() && matches.size() < 2) {
    const StateLock lock(farm_);
    if (lock->scheduler.worker_info({id_or_name}) != nullptr) return id_or_name;
    const auto views = lock->scheduler.workers(lock.now(), {after}, kWorkersAtOnce);
    for (const scheduler::WorkerView& view : views) {
      const std::string& id = view.info.id.value;
      if (view.info.name == id_or_name || id.starts_with(id_or_name)) matches.push_back(id);
    }
    if (views.size() < kWorkersAtOnce) break;
    after = views.back().info.id.value;
  }
  if (matches.empty())
    return core::fail(ErrorCode::kNotFound,
                      fmt::format("there is no worker '{}': tessera workers lists them", id_or_name));
  if (matches.size() > 1)
    return core::fail(ErrorCode::kFailedPrecondition,
                      fmt::format("'{}' could be worker {:.12} or worker {:.12}: give more of its id",
                                  id_or_name, matches[0], matches[1]));
  return matches[0];
}

core::Result<v1::DrainWorkerResponse> Fleet::drain(const v1::DrainWorkerRequest& request) {
  if (request.undo() && request.stop())
    return core::fail(ErrorCode::kInvalidArgument, "undo, stop: only one of them is possible");
  const auto id = find_worker(request.worker());
  if (!id) return core::fail(id.error());
  StateLock lock(farm_);
  const scheduler::Actions done = lock.handle(scheduler::Drain{{*id}, !request.undo(), request.stop()});
  if (!done.status) return core::fail(done.status.error());
  const char* what = request.undo() ? "may take leases again" : "takes no more leases";
  lock.log(spdlog::level::info, fmt::format("worker {} {}, as an administrator asked{}", *id, what,
                                            request.stop() ? ", and then stops" : ""));
  v1::DrainWorkerResponse response;
  response.set_worker_id(*id);
  return response;
}

}  // namespace tessera::fleet
