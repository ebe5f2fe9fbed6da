// SPDX-License-Identifier: Apache-2.0
// Calls of Synchronize that are not answered yet: a worker's call waits until there is a change for the
// worker, or its heartbeat is due. Guarded by the state lock.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.hpp"
#include "server/scheduler/events.hpp"
#include "tessera/v1/worker_service.pb.h"

namespace tessera::farm {

class StateLock;

// The principal of a worker's call.
struct WorkerPrincipal {
  // See scheduler::WorkerInfo.
  std::string name{};
  bool individual = false;
  std::string origin{};
  // The address of its machine, for the log.
  std::string peer{};
};

// The caller that waits for the answer to a Synchronize.
struct SynchronizeCaller {
  // Called exactly once, on any thread, without the state lock.
  std::function<void(core::Result<v1::SynchronizeResponse>)> answer;
  // Whether the caller has gone. Called on any thread until `answer` is called. A caller that has gone is
  // given no leases. Its call is removed when it is due, unless Dispatcher::remove_gone() is called before.
  std::function<bool()> is_gone = [] { return false; };
  WorkerPrincipal principal{};
};

struct WaitingCall {
  SynchronizeCaller caller;
  std::set<std::string> known_jobs;  // whose specs the worker has
  scheduler::Time deadline;
};

// By worker, and by the time at which they are due.
class WaitingCalls {
 public:
  // The worker must have none.
  void add(const std::string& worker, WaitingCall call);
  // Null if the worker has none.
  WaitingCall* find(const std::string& worker);
  const WaitingCall* find(const std::string& worker) const;
  // Removes the call of a worker that has one.
  WaitingCall take(const std::string& worker);

  // The workers whose calls are due, the most overdue first; at most so many.
  std::vector<std::string> due(scheduler::Time now, std::size_t most) const;
  const std::map<std::string, WaitingCall>& all() const { return calls_; }
  std::size_t size() const { return calls_.size(); }

 private:
  std::map<std::string, WaitingCall> calls_;
  std::set<std::pair<scheduler::Time, std::string>> by_deadline_;
};

// What a worker is told, without the lock: leases, and the jobs among them that it does not know.
class LeaseMessages {
 public:
  LeaseMessages(const StateLock& lock, scheduler::Reply reply, const std::set<std::string>& known_jobs);

  bool empty() const { return reply_.leases.empty(); }
  // Builds the messages. Needs no lock.
  v1::SynchronizeResponse build() const;

 private:
  scheduler::Reply reply_;
  std::map<std::string, std::shared_ptr<const v1::Job>> specs_;  // of the jobs in reply_
  std::set<std::string> unknown_jobs_;
};

// Answers the waiting call of a worker, if there is one.
void answer(StateLock& lock, const std::string& worker, const scheduler::Reply& reply);
// Answers a caller with an error.
void refuse(StateLock& lock, SynchronizeCaller caller, const core::Error& error);
// Answers the waiting call of a worker whose caller has gone. Returns whether there was one.
bool refuse_if_gone(StateLock& lock, const std::string& worker);
// Offers new work to a worker whose call waits; `answer_unchanged`: answers the call in any case. Returns
// what the caller must apply.
scheduler::Actions top_up(StateLock& lock, const std::string& worker, bool answer_unchanged) noexcept;

}  // namespace tessera::farm
