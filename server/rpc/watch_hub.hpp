// Sees to it that everyone who watches a job hears of its changes. Thread-safe.
#pragma once

#include <map>
#include <mutex>
#include <set>
#include <string>

#include "server/coordinator/coordinator.hpp"
#include "server/coordinator/periodic.hpp"

namespace tessera::rpc {

// Who is told. Called under the hub's lock; must not block and not call the hub.
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
  void remove(Watcher& watcher);
  // Tells all watchers, and all later ones, that the coordinator is stopping.
  void close();

  // Held while watchers are told; also guards what they share with gRPC's callbacks.
  std::mutex& mutex() { return mutex_; }

 private:
  // What all watchers of a job are told of it in one round: it is looked up once.
  using Known = std::map<std::string, core::Result<v1::Job>>;
  void tell(Watcher& watcher, Known& known);
  void tell_all();  // under the lock

  coordinator::Coordinator& coordinator_;
  std::mutex mutex_;
  std::set<Watcher*> watchers_;  // guarded by mutex_
  bool closed_ = false;          // guarded by mutex_
  coordinator::Periodic teller_;
};

}  // namespace tessera::rpc
