// SPDX-License-Identifier: Apache-2.0
// Counts the rejected results of each worker: those of a broken machine, a wrong build or an attacker. After
// too many in a row, or when others have disproved its results, a worker is quarantined until the coordinator
// restarts, together with every later worker of its machine (scheduler::WorkerInfo::machine) where that is
// known. Names do not count, since anybody can take one. Not thread-safe; guarded by the state lock.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>

namespace tessera::farm {

class Quarantine {
 public:
  static constexpr int kRejectionsUntilQuarantine = 3;

  // Counts a rejected result of this worker. Returns whether the worker is quarantined by it.
  bool refused(const std::string& worker, const std::string& machine);
  // Quarantines the worker for another reason, given as a part of a sentence. Returns false if it was
  // quarantined already.
  bool quarantined(const std::string& worker, const std::string& machine, const std::string& because);
  // Counts a valid result of the worker.
  void in_order(const std::string& worker);
  // Forgets all other workers, except that those in quarantine stay in it.
  void forget_others(const std::set<std::string>& present);

  std::uint64_t refusals(const std::string& worker) const;
  bool is_quarantined(const std::string& worker) const;
  bool is_machine_aside(const std::string& machine) const { return machines_aside_.contains(machine); }
  // Why this worker, or the first of this machine, is quarantined, as a part of a sentence. Empty if neither
  // is.
  std::string because(const std::string& worker, const std::string& machine) const;

 private:
  struct Entry {
    std::uint64_t refused = 0;
    int in_a_row = 0;
    bool aside = false;
    std::string because;
  };
  std::map<std::string, Entry> entries_;               // by worker
  std::map<std::string, std::string> machines_aside_;  // quarantined machines with the reason
};

}  // namespace tessera::farm
