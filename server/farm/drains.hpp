// SPDX-License-Identifier: Apache-2.0
// Workers that an administrator has asked to drain, also while the scheduler does not know them: after a
// restart of the coordinator, until they call. Not thread-safe; guarded by the state lock.
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>

namespace tessera::farm {

struct Drain {
  bool stop = false;  // its process must end, too
  bool operator==(const Drain&) const = default;
};

class Drains {
 public:
  void request(const std::string& worker, Drain drain) {
    drains_[worker] = drain;
    changes_.insert(worker);
  }
  // The worker may take leases again, or is forgotten.
  void forget(const std::string& worker) {
    if (drains_.erase(worker) > 0) changes_.insert(worker);
  }

  // Null if the worker need not drain.
  const Drain* find(const std::string& worker) const {
    const auto found = drains_.find(worker);
    return found == drains_.end() ? nullptr : &found->second;
  }
  const std::map<std::string, Drain>& all() const { return drains_; }

  // The workers whose drains have changed since the last call.
  std::set<std::string> take_changes() { return std::exchange(changes_, {}); }
  // Puts changes back that could not be stored.
  void return_changes(std::set<std::string> changes) { changes_.merge(std::move(changes)); }

 private:
  std::map<std::string, Drain> drains_;  // by worker
  std::set<std::string> changes_;
};

}  // namespace tessera::farm
