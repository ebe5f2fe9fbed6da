// SPDX-License-Identifier: Apache-2.0
#include "server/farm/quarantine.hpp"

#include <utility>

namespace tessera::farm {

namespace {

using WorkersByKey = std::map<std::string, std::set<std::string>>;

const std::set<std::string>& workers_of(const WorkersByKey& workers, const std::string& key) {
  static const std::set<std::string> kNone;
  const auto found = workers.find(key);
  return found == workers.end() ? kNone : found->second;
}

void enter(WorkersByKey& workers, const std::string& key, const std::string& worker) {
  if (!key.empty()) workers[key].insert(worker);
}

void leave(WorkersByKey& workers, const std::string& key, const std::string& worker) {
  const auto found = workers.find(key);
  if (found == workers.end()) return;
  found->second.erase(worker);
  if (found->second.empty()) workers.erase(found);
}

}  // namespace

bool Quarantine::refused(const std::string& worker) {
  Rejections& rejections = rejections_[worker];
  ++rejections.all;
  return ++rejections.in_a_row >= kRejectionsUntilQuarantine;
}

void Quarantine::in_order(const std::string& worker) {
  const auto found = rejections_.find(worker);
  if (found != rejections_.end()) found->second.in_a_row = 0;
}

std::uint64_t Quarantine::refusals(const std::string& worker) const {
  const auto found = rejections_.find(worker);
  return found == rejections_.end() ? 0 : found->second.all;
}

bool Quarantine::add(QuarantineEntry entry) {
  const std::string worker = entry.producer.worker.value;
  const auto [added, is_new] = entries_.try_emplace(worker, std::move(entry));
  if (!is_new) return false;
  by_age_.insert(position_of(added->second));
  enter(by_machine_, added->second.producer.machine, worker);
  enter(by_principal_, added->second.producer.principal, worker);
  changes_.insert(worker);
  if (entries_.size() > kMaxEntries) remove(std::string(by_age_.begin()->second));
  return true;
}

void Quarantine::remove(const std::string& worker) {
  const auto entry = entries_.find(worker);
  by_age_.erase(position_of(entry->second));
  leave(by_machine_, entry->second.producer.machine, worker);
  leave(by_principal_, entry->second.producer.principal, worker);
  entries_.erase(entry);
  changes_.insert(worker);
}

std::vector<QuarantineEntry> Quarantine::lift(const std::string& worker) {
  std::vector<QuarantineEntry> lifted;
  const auto entry = entries_.find(worker);
  if (entry == entries_.end()) return lifted;
  std::set<std::string> workers{worker};
  workers.merge(std::set(workers_of(by_machine_, entry->second.producer.machine)));
  workers.merge(std::set(workers_of(by_principal_, entry->second.producer.principal)));
  for (const std::string& each : workers) {
    lifted.push_back(entries_.at(each));
    remove(each);
    in_order(each);
  }
  return lifted;
}

std::vector<QuarantineEntry> Quarantine::entries_after(const Position& position, std::size_t most) const {
  std::vector<QuarantineEntry> entries;
  for (auto next = by_age_.upper_bound(position); next != by_age_.end() && entries.size() < most; ++next)
    entries.push_back(entries_.at(next->second));
  return entries;
}

const QuarantineEntry* Quarantine::entry_of(const std::string& worker) const {
  const auto found = entries_.find(worker);
  return found == entries_.end() ? nullptr : &found->second;
}

const QuarantineEntry* Quarantine::find(const scheduler::Producer& worker, bool is_registered) const {
  if (const QuarantineEntry* const own = entry_of(worker.worker.value)) return own;
  const std::set<std::string>* alike = &workers_of(by_principal_, worker.principal);
  if (alike->empty() && !is_registered) alike = &workers_of(by_machine_, worker.machine);
  return alike->empty() ? nullptr : &entries_.at(*alike->begin());
}

std::set<std::string> Quarantine::take_changes() {
  return std::exchange(changes_, {});
}

void Quarantine::return_changes(std::set<std::string> changes) {
  changes_.merge(std::move(changes));
}

}  // namespace tessera::farm
