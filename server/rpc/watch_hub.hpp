// SPDX-License-Identifier: Apache-2.0
// Tells all watchers of a job about its changes. Thread-safe.
#pragma once

#include <atomic>
#include <map>
#include <string>

#include "server/base/periodic.hpp"
#include "server/coordinator.hpp"
#include "server/rpc/observer_list.hpp"

namespace tessera::rpc {

// An observer of one job. Called on any thread, under no lock of the hub; must not call the hub.
class Watcher {
 public:
  virtual ~Watcher() = default;
  virtual const std::string& job_id() const = 0;
  // Receives the current job, changed or not, or the reason why nothing more will come.
  virtual void tell(const core::Result<v1::Job>& job) = 0;
};

class WatchHub {
 public:
  explicit WatchHub(server::Coordinator& coordinator);
  ~WatchHub();

  // Tells the watcher at once, and then about ten times a second until it is removed.
  void add(Watcher& watcher);
  // The watcher is not told after this returns.
  void remove(Watcher& watcher) { watchers_.remove(watcher); }
  // Tells all watchers, and all later ones, that the coordinator is stopping.
  void close();

 private:
  // The jobs that were looked up in this round: each once for all its watchers.
  using Known = std::map<std::string, core::Result<v1::Job>>;
  void tell(Watcher& watcher, Known& known);
  void tell_all();

  server::Coordinator& coordinator_;
  std::atomic<bool> closed_{false};
  ObserverList<Watcher> watchers_;
  base::Periodic teller_;
};

}  // namespace tessera::rpc
