// SPDX-License-Identifier: Apache-2.0
// Sees to it that everyone who watches a job hears of its changes. Thread-safe.
#pragma once

#include <atomic>
#include <map>
#include <string>

#include "server/coordinator/coordinator.hpp"
#include "server/coordinator/periodic.hpp"
#include "server/rpc/observer_list.hpp"

namespace tessera::rpc {

// Who is told. Called under no lock of the hub, by one thread or another; must not call the hub.
class Watcher {
 public:
  virtual ~Watcher() = default;
  virtual const std::string& job_id() const = 0;
  // The job as it is, changed or not; or why nothing more will come.
  virtual void tell(const core::Result<v1::Job>& job) = 0;
};

class WatchHub {
 public:
  explicit WatchHub(coordinator::Coordinator& coordinator);
  ~WatchHub();

  // Tells it at once, and again about ten times a second until it is removed.
  void add(Watcher& watcher);
  // Afterwards it is not told any more.
  void remove(Watcher& watcher) { watchers_.remove(watcher); }
  // Tells all watchers, and all later ones, that the coordinator is stopping.
  void close();

 private:
  // What all watchers of a job are told of it in one round: it is looked up once.
  using Known = std::map<std::string, core::Result<v1::Job>>;
  void tell(Watcher& watcher, Known& known);
  void tell_all();

  coordinator::Coordinator& coordinator_;
  std::atomic<bool> closed_{false};
  ObserverList<Watcher> watchers_;
  coordinator::Periodic teller_;
};

}  // namespace tessera::rpc
