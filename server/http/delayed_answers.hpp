// SPDX-License-Identifier: Apache-2.0
// Calls that wait: answers to callers that are rejected often, which are sent a second later, and images that
// wait for memory, for a while at most. Thread-safe.
#pragma once

#include <chrono>
#include <functional>
#include <list>
#include "core/base/mutex.hpp"

#include "server/base/periodic.hpp"

namespace tessera::http_api {

class DelayedAnswers {
 public:
  using Clock = std::chrono::steady_clock;

  DelayedAnswers() : checker_(kPeriod, [this] { run_due(); }) {}

  // Calls the function after this time, on a thread for all of them: it must be short.
  void after(Clock::duration delay, std::function<void()> call) {
    const core::MutexLock lock(mutex_);
    waiting_.push_back({Clock::now() + delay, std::move(call)});
  }

 private:
  static constexpr std::chrono::milliseconds kPeriod{250};
  struct Waiting {
    Clock::time_point due;
    std::function<void()> call;
  };

  void run_due() {
    std::list<Waiting> due;
    {
      const core::MutexLock lock(mutex_);
      const Clock::time_point now = Clock::now();
      for (auto next = waiting_.begin(); next != waiting_.end();) {
        const auto each = next++;
        if (each->due <= now) due.splice(due.end(), waiting_, each);
      }
    }
    for (const Waiting& each : due) each.call();
  }

  core::Mutex mutex_;
  std::list<Waiting> waiting_ TESSERA_GUARDED_BY(mutex_);
  base::Periodic checker_;
};

}  // namespace tessera::http_api
