// SPDX-License-Identifier: Apache-2.0
// Which workers get no leases: those of a broken machine, a wrong build or an attacker. A worker is
// quarantined after too many rejected results in a row, or when others have disproved its results. With it
// are quarantined, where they are known, its principal if that is individual, and every later worker of its
// machine (scheduler::WorkerInfo). Names do not count, since anybody can take one. Not thread-safe; guarded
// by the state lock.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "server/scheduler/producer.hpp"

namespace tessera::farm {

struct QuarantineEntry {
  // Identifies the entry by its worker.
  scheduler::Producer producer;
  // For display, also if it is not individual.
  std::string principal{};
  // The reason, as a part of a sentence.
  std::string because{};
  std::int64_t since_ms = 0;  // since 1970-01-01 UTC
  bool operator==(const QuarantineEntry&) const = default;
};

class Quarantine {
 public:
  static constexpr int kRejectionsUntilQuarantine = 3;
  // The oldest entry goes when there are more: without credentials, a caller can invent any number of
  // workers.
  static constexpr std::size_t kMaxEntries = 4096;

  // Counts a rejected result of this worker. Returns whether it is one too many in a row.
  bool refused(const std::string& worker);
  // Counts a valid result of the worker.
  void in_order(const std::string& worker);
  std::uint64_t refusals(const std::string& worker) const;
  // Forgets the rejected results of the worker.
  void forget(const std::string& worker) { rejections_.erase(worker); }

  // Returns false if the worker has an entry already.
  bool add(QuarantineEntry entry);
  // Removes the entry of a worker, and those of its machine and its principal. Returns them; empty if the
  // worker has none.
  std::vector<QuarantineEntry> lift(const std::string& worker);

  // The entry by which a worker gets no leases; null if there is none. Workers that were registered before
  // their machine was quarantined are judged by their own results.
  const QuarantineEntry* find(const scheduler::Producer& worker, bool is_registered) const;
  // The place of an entry among all: by its time, and its worker.
  using Position = std::pair<std::int64_t, std::string>;
  static Position position_of(const QuarantineEntry& entry) {
    return {entry.since_ms, entry.producer.worker.value};
  }
  // Those after this position, at most so many; the oldest first.
  std::vector<QuarantineEntry> entries_after(const Position& position, std::size_t most) const;
  // Null if the worker has none of its own.
  const QuarantineEntry* entry_of(const std::string& worker) const;
  std::size_t size() const { return entries_.size(); }

  // The workers whose entries were added or removed since the last call.
  std::set<std::string> take_changes();
  // Puts changes back that could not be stored.
  void return_changes(std::set<std::string> changes);

 private:
  struct Rejections {
    std::uint64_t all = 0;
    int in_a_row = 0;
  };
  void remove(const std::string& worker);

  std::map<std::string, Rejections> rejections_;    // by worker
  std::map<std::string, QuarantineEntry> entries_;  // by worker
  // The workers of the entries by time, and by machine and individual principal, where these are known.
  std::set<Position> by_age_;
  std::map<std::string, std::set<std::string>> by_machine_, by_principal_;
  std::set<std::string> changes_;
};

}  // namespace tessera::farm
