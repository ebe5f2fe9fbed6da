// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/rejections.hpp"

#include <fmt/format.h>

#include <chrono>

namespace tessera::rpc {

bool Rejections::note(const std::string& machine, const std::string& method, const grpc::Status& why) {
  {
    const std::lock_guard lock(mutex_);
    log_.warn(fmt::format("rejected {} of {}: {}", method, machine, why.error_message()),
              std::chrono::steady_clock::now());
  }
  return rate_.take(machine).has_value();
}

void Rejections::flush() {
  const std::lock_guard lock(mutex_);
  log_.flush(std::chrono::steady_clock::now());
}

}  // namespace tessera::rpc
