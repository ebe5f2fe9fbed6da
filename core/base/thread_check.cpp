// SPDX-License-Identifier: Apache-2.0
#include "core/base/thread_check.hpp"

#include <fmt/format.h>

#include <future>
#include <system_error>
#include <thread>
#include <vector>

namespace tessera::core {

Status check_threads(int threads) try {
  std::promise<void> release;
  const std::shared_future<void> released = release.get_future().share();
  std::vector<std::jthread> started;
  Status all;
  for (int i = 1; i < threads && all; ++i) {
    try {
      started.emplace_back([released] { released.wait(); });
    } catch (const std::system_error&) {
      all = fail(ErrorCode::kResourceExhausted,
                 fmt::format("not enough memory: {} of {} threads can be started; use fewer", i, threads));
    }
  }
  release.set_value();
  return all;
} catch (const std::bad_alloc&) {
  return fail(ErrorCode::kResourceExhausted,
              fmt::format("not enough memory for {} threads: use fewer", threads));
}

}  // namespace tessera::core
