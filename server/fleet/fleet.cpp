// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/fleet.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "server/farm/pages.hpp"
#include "server/farm/state_lock.hpp"
#include "server/fleet/stored_worker.hpp"

namespace tessera::fleet {

using core::ErrorCode;
using farm::Quarantine;
using farm::QuarantineEntry;
using farm::StateLock;

namespace {

// What is looked at in one hold of the state lock.
constexpr std::size_t kWorkersAtOnce = 64;

// Before all entries of the quarantine.
const Quarantine::Position kBeginning{std::numeric_limits<std::int64_t>::min(), ""};

// A token is the position of the last entry of its page.
std::string token_of(const Quarantine::Position& position) {
  return fmt::format("{}-{}", position.first, position.second);
}

core::Result<Quarantine::Position> position_of(const std::string& token) {
  if (token.empty()) return kBeginning;
  Quarantine::Position position;
  const char* const end = token.data() + token.size();
  const auto [rest, error] = std::from_chars(token.data(), end, position.first);
  if (error != std::errc() || rest == end || *rest != '-')
    return core::fail(ErrorCode::kInvalidArgument, "page_token: is not that of an earlier response");
  position.second.assign(rest + 1, end);
  return position;
}

std::vector<StoredWorker> take_changes(farm::Farm& farm) {
  StateLock lock(farm);
  std::set<std::string> changed = lock->quarantine.take_changes();
  changed.merge(lock->drains.take_changes());
  std::vector<StoredWorker> workers;
  for (const std::string& id : changed) {
    StoredWorker worker{id};
    if (const QuarantineEntry* const entry = lock->quarantine.entry_of(id)) worker.quarantine = *entry;
    if (const farm::Drain* const drain = lock->drains.find(id)) worker.drain = *drain;
    workers.push_back(std::move(worker));
  }
  return workers;
}

core::Status write(store::JobStore& store, const StoredWorker& worker) {
  const bool is_empty = !worker.quarantine && !worker.drain;
  return is_empty ? store.delete_quarantine(worker.id) : store.write_quarantine(worker.id, encode(worker));
}

}  // namespace

core::Status Fleet::restore() {
  const auto rows = store_.quarantine();
  if (!rows) return core::fail(rows.error());
  for (const store::QuarantineRow& row : *rows) restore(row);
  const core::MutexLock saving(saving_);
  StateLock lock(farm_);
  lock->quarantine.take_changes();
  lock->drains.take_changes();
  forget_absent_at_ = lock.now() + lock.options().forget_after();
  const std::size_t quarantined = lock->quarantine.size(), drained = lock->drains.all().size();
  const auto say = [&](std::size_t workers, const char* what) {
    if (workers > 0)
      lock.log(spdlog::level::info, fmt::format("{} workers {} since an earlier run", workers, what));
  };
  say(quarantined, "are quarantined");
  say(drained, "drain");
  return {};
}

void Fleet::restore(const store::QuarantineRow& row) {
  auto worker = row.intact ? decode(row.content) : std::nullopt;
  if (!worker)
    return spdlog::error("what is stored of worker {} is damaged: its quarantine or drain no longer applies",
                         row.id);
  StateLock lock(farm_);
  if (worker->drain) lock->drains.request(worker->id, *worker->drain);
  if (!worker->quarantine) return;
  lock.handle(scheduler::Distrust{worker->quarantine->producer});
  lock->quarantine.add(*std::move(worker->quarantine));
}

core::Status Fleet::save() {
  const core::MutexLock saving(saving_);
  forget_absent();
  std::set<std::string> left;
  core::Status saved;
  for (const StoredWorker& worker : take_changes(farm_)) {
    if (saved) saved = write(store_, worker);
    if (!saved) left.insert(worker.id);
  }
  if (!left.empty()) StateLock(farm_)->drains.return_changes(std::move(left));
  return saved;
}

void Fleet::forget_absent() {
  if (!forget_absent_at_) return;
  StateLock lock(farm_);
  if (lock.now() < *forget_absent_at_) return;
  forget_absent_at_.reset();
  const std::map<std::string, farm::Drain> drains = lock->drains.all();
  for (const auto& [id, drain] : drains)
    if (lock->scheduler.worker_info({id}) == nullptr) lock->drains.forget(id);
}

core::Result<v1::ListQuarantineResponse> Fleet::list_quarantine(const v1::ListQuarantineRequest& request) {
  auto position = position_of(request.page_token());
  if (!position) return core::fail(position.error());
  const auto entries_after = [this](const Quarantine::Position& after, std::size_t most) {
    const StateLock lock(farm_);
    return lock->quarantine.entries_after(after, most);
  };
  const auto most = static_cast<std::size_t>(farm::page_size(request.page_size()));
  v1::ListQuarantineResponse page;
  for (std::size_t left = most; left > 0;) {
    const auto entries = entries_after(*position, std::min(left, kWorkersAtOnce));
    if (entries.empty()) return page;
    for (const QuarantineEntry& entry : entries) *page.add_entries() = to_wire(entry);
    position = Quarantine::position_of(entries.back());
    left -= entries.size();
  }
  if (!entries_after(*position, 1).empty()) page.set_next_page_token(token_of(*position));
  return page;
}

core::Status Fleet::lift(const std::string& id) {
  {
    StateLock lock(farm_);
    if (auto enough = lock.expect_memory(); !enough) return enough;
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
  {
    StateLock lock(farm_);
    if (auto enough = lock.expect_memory(); !enough) return core::fail(enough.error());
    const scheduler::Actions done = lock.handle(scheduler::Drain{{*id}, !request.undo(), request.stop()});
    if (!done.status) return core::fail(done.status.error());
    request.undo() ? lock->drains.forget(*id) : lock->drains.request(*id, {request.stop()});
    const char* what = request.undo() ? "may take leases again" : "takes no more leases";
    lock.log(spdlog::level::info, fmt::format("worker {} {}, as an administrator asked{}", *id, what,
                                              request.stop() ? ", and then stops" : ""));
  }
  if (auto saved = save(); !saved) return core::fail(saved.error());
  v1::DrainWorkerResponse response;
  response.set_worker_id(*id);
  return response;
}

}  // namespace tessera::fleet
