// SPDX-License-Identifier: Apache-2.0
#include "client/background_task.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <new>
#include <stop_token>
#include <utility>

#include "client/console.hpp"

namespace tessera::client {
namespace {

// Whether the whole time has passed.
bool sleep_unless_stopped(const std::stop_token& stop, double seconds) {
  std::mutex mutex;
  std::condition_variable_any never;
  std::unique_lock lock(mutex);
  never.wait_for(lock, stop, std::chrono::duration<double>(seconds), [] { return false; });
  return !stop.stop_requested();
}

core::Status attempt(const std::function<core::Status()>& task) try {
  return task();
} catch (const std::bad_alloc&) {
  return core::fail(core::ErrorCode::kResourceExhausted, "not enough memory");
} catch (const std::exception& error) {
  return core::fail(core::ErrorCode::kInternal, error.what());
}

}  // namespace

BackgroundTask::BackgroundTask(double seconds, std::function<core::Status()> task,
                               std::function<void(const std::string&)> report)
    : thread_([seconds, task = std::move(task), report = std::move(report)](const std::stop_token& stop) {
        double pause = seconds;
        while (sleep_unless_stopped(stop, pause)) {
          const double start = steady_seconds();
          const core::Status done = attempt(task);
          if (!done) report(done.error().message);
          const double taken = steady_seconds() - start;
          pause = std::max(seconds - taken, taken);
        }
      }) {}

}  // namespace tessera::client
