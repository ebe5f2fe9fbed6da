// SPDX-License-Identifier: Apache-2.0
#include "server/auth/rejections.hpp"

#include <fmt/format.h>
#include <chrono>
#include <optional>

#include "core/common/log.hpp"

namespace tessera::auth {

template <typename Take>
void Rejections::log(Take take) {
  std::optional<common::LogLine> line;
  {
    const core::MutexLock lock(mutex_);
    line = take(log_);
  }
  if (line) common::log(*line);
}

bool Rejections::note(const std::string& machine, const std::string& method, const grpc::Status& why) {
  log([&](common::RateLimitedLog& log) {
    return log.note(
        {fmt::format("rejected {} of {}: {}", method, machine, why.error_message()), {.peer = machine}},
        std::chrono::steady_clock::now());
  });
  return rate_.take(machine).has_value();
}

void Rejections::flush() {
  log([](common::RateLimitedLog& log) { return log.take_due(std::chrono::steady_clock::now()); });
}

}  // namespace tessera::auth
