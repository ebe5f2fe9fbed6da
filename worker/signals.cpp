// SPDX-License-Identifier: Apache-2.0
#include "worker/signals.hpp"

#include <pthread.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <csignal>
#include <ctime>
#include <utility>

namespace tessera::worker {
namespace {

sigset_t handled_signals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&set, signal);
  return set;
}

// The next signal; not positive if none came within the polling interval.
int next_signal(const sigset_t& set) {
  constexpr timespec kLookAround{0, 100'000'000};
  return sigtimedwait(&set, nullptr, &kLookAround);
}

}  // namespace

StopSignals::StopSignals() {
  const sigset_t set = handled_signals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  thread_ = std::jthread([this](const std::stop_token& not_needed) { listen(not_needed); });
}

void StopSignals::listen(const std::stop_token& not_needed) {
  const sigset_t set = handled_signals();
  while (!not_needed.stop_requested()) {
    const int signal = next_signal(set);
    if (signal == SIGHUP) {
      note_hangup();
    } else if (signal > 0) {
      note_stop(signal);
    }
  }
}

void StopSignals::note_stop(int signal) {
  // Cluster managers repeat SIGTERM: a hook, the end of a step, the end of its job. They kill what takes
  // long.
  if (stop_.stop_requested() && signal == SIGINT) _exit(128 + signal);
  if (!stop_.stop_requested())
    spdlog::info("stopping: delivering what is rendered (SIGINT once more to stop at once)");
  stop_.request_stop();
}

void StopSignals::note_hangup() {
  std::function<void()> call;
  {
    const core::MutexLock lock(mutex_);
    call = hangup_;
  }
  if (call) call();
}

void StopSignals::on_hangup(std::function<void()> call) {
  const core::MutexLock lock(mutex_);
  hangup_ = std::move(call);
}

}  // namespace tessera::worker
