// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/timeline.hpp"

#include <utility>

namespace tessera::bench {

Timeline::Timeline() : thread_([this](const std::stop_token& stop) { run(stop); }) {}

Timeline::~Timeline() {
  thread_.request_stop();
  thread_.join();
}

void Timeline::after(Seconds delay, std::function<void()> action) {
  const Clock::time_point at = Clock::now() + std::chrono::duration_cast<Clock::duration>(delay);
  bool first = false;
  {
    const std::lock_guard lock(mutex_);
    const auto entry = due_.emplace(at, std::move(action));
    first = entry == due_.begin();
  }
  if (first) changed_.notify_one();
}

void Timeline::run(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    if (due_.empty()) {
      changed_.wait(lock, stop, [this] { return !due_.empty(); });
      continue;
    }
    const Clock::time_point next = due_.begin()->first;
    if (Clock::now() < next) {
      changed_.wait_until(lock, stop, next, [&] { return due_.begin()->first < next; });
      continue;
    }
    const std::function<void()> action = std::move(due_.extract(due_.begin()).mapped());
    lock.unlock();
    action();
    lock.lock();
  }
}

}  // namespace tessera::bench
