// SPDX-License-Identifier: Apache-2.0
#include "worker/waiting.hpp"

#include <condition_variable>

#include "core/base/mutex.hpp"

namespace tessera::worker {

bool wait_for(const std::stop_token& stop, proto::Duration duration) {
  core::Mutex mutex;
  core::MutexLock lock(mutex);
  std::condition_variable_any never_notified;
  never_notified.wait_for(lock.native(), stop, duration, [] { return false; });
  return !stop.stop_requested();
}

proto::Waiter waiter_until(const std::stop_token& stop) {
  proto::Waiter waiter = proto::real_time();
  waiter.wait = [stop](proto::Duration duration) { return wait_for(stop, duration); };
  return waiter;
}

StallGuard::StallGuard(std::function<void()> cancel, proto::Duration max_silence)
    : last_(std::chrono::steady_clock::now().time_since_epoch()),
      watch_([this, cancel = std::move(cancel), max_silence](const std::stop_token& done) {
        const auto silence = [this] {
          return std::chrono::steady_clock::now().time_since_epoch() - last_.load();
        };
        while (silence() < max_silence)
          if (!wait_for(done, max_silence - silence())) return;
        cancel();
      }) {}

StoppableCall::StoppableCall(const std::stop_token& stop, proto::Duration deadline)
    : on_stop_(stop, Cancel{&context_}) {
  context_.set_deadline(std::chrono::system_clock::now() +
                        std::chrono::duration_cast<std::chrono::system_clock::duration>(deadline));
}

}  // namespace tessera::worker
