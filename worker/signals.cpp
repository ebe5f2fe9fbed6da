// SPDX-License-Identifier: Apache-2.0
#include "worker/signals.hpp"

#include <pthread.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <csignal>
#include <ctime>

namespace tessera::worker {
namespace {

sigset_t stop_signals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  return set;
}

// The next signal; not positive if none came within the polling interval.
int next_signal(const sigset_t& set) {
  constexpr timespec kLookAround{0, 100'000'000};
  return sigtimedwait(&set, nullptr, &kLookAround);
}

void listen(const std::stop_token& not_needed, std::stop_source stop) {
  const sigset_t set = stop_signals();
  while (!not_needed.stop_requested()) {
    const int signal = next_signal(set);
    if (signal <= 0) continue;
    // Cluster managers repeat SIGTERM: a hook, the end of a step, the end of its job. They kill what takes
    // long.
    if (stop.stop_requested() && signal == SIGINT) _exit(128 + signal);
    if (!stop.stop_requested())
      spdlog::info("stopping: delivering what is rendered (SIGINT once more to stop at once)");
    stop.request_stop();
  }
}

}  // namespace

StopSignals::StopSignals() {
  const sigset_t set = stop_signals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  thread_ = std::jthread(listen, stop_);
}

}  // namespace tessera::worker
