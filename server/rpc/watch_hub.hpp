// SPDX-License-Identifier: Apache-2.0
// Tells watchers when what they watch has changed, at most ten times a second. Sleeps while nothing changes.
// Thread-safe.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <set>
#include <string>
#include <thread>

#include "core/base/mutex.hpp"
#include "server/events/event_log.hpp"
#include "server/rpc/observer_list.hpp"

namespace tessera::rpc {

// Somebody who watches a job, or all jobs and workers. Called on any thread, under no lock of the hub; must
// not add or remove watchers.
class Watcher {
 public:
  virtual ~Watcher() = default;
  // Empty: all jobs and workers.
  virtual const std::string& job_id() const = 0;
  // `changed`: what is watched may have changed. Returns whether to call again in the next round in any case.
  virtual bool notify(bool changed) = 0;
  // The coordinator is stopping.
  virtual void close() = 0;
};

class WatchHub {
 public:
  // Rounds, in which watchers learn of changes, follow each other at this distance at least.
  static constexpr std::chrono::milliseconds kShortestRound{100};

  explicit WatchHub(events::EventLog& log);
  ~WatchHub();

  // Notifies the watcher at once, and then of every change until it is removed.
  void add(Watcher& watcher);
  // The watcher is not notified after this returns.
  void remove(Watcher& watcher) { watchers_.remove(watcher); }
  // There is a next round soon, though nothing may have changed.
  void request_round();
  // Closes all watchers, and all later ones.
  void close();

 private:
  void run();
  // The jobs that have changed since the last round. Returns false if nothing has.
  bool read_events(std::set<std::string>& jobs);
  // Whether another round is due in any case.
  bool notify_all(bool any_changed, const std::set<std::string>& jobs);
  void pause();

  events::EventLog& log_;
  events::Cursor cursor_;  // used by the thread only
  std::atomic<bool> closed_{false};
  ObserverList<Watcher> watchers_;
  core::Mutex mutex_;
  std::condition_variable stop_;
  bool stopping_ TESSERA_GUARDED_BY(mutex_) = false;
  std::thread thread_;
};

}  // namespace tessera::rpc
