// SPDX-License-Identifier: Apache-2.0
// Which workers' results were refused, and how often: those of a broken machine, a wrong build or a liar.
// After too many in a row, or when others have disproved it, a worker is quarantined, and every later worker of
// its machine (scheduler::WorkerInfo::machine) with it, where that is known, until the coordinator is started
// anew. Names do not count: anybody can take one. Not thread-safe; the coordinator's gate guards it.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>

namespace tessera::coordinator {

class Quarantine {
 public:
  static constexpr int kRejectionsUntilQuarantine = 3;

  // A result of this worker was refused. Whether that was once too often.
  bool refused(const std::string& worker, const std::string& machine);
  // The same for any other reason, a part of a sentence. Whether it was not aside already.
  bool quarantined(const std::string& worker, const std::string& machine, const std::string& because);
  // A result of it was in order.
  void in_order(const std::string& worker);
  // All workers but these are forgotten; who was quarantined stays so.
  void forget_others(const std::set<std::string>& present);

  std::uint64_t refusals(const std::string& worker) const;
  bool is_quarantined(const std::string& worker) const;
  bool is_machine_aside(const std::string& machine) const { return machines_aside_.contains(machine); }
  // Why this worker, or the first of this machine, is aside: part of a sentence. Empty if neither is.
  std::string because(const std::string& worker, const std::string& machine) const;

 private:
  struct Entry {
    std::uint64_t refused = 0;
    int in_a_row = 0;
    bool aside = false;
    std::string because;
  };
  std::map<std::string, Entry> entries_;               // by worker
  std::map<std::string, std::string> machines_aside_;  // and why
};

}  // namespace tessera::coordinator
