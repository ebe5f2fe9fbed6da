// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/readiness.hpp"

#include <fmt/format.h>

#include <utility>

namespace tessera::rpc {

void Readiness::note_lock(Clock::time_point now) {
  const core::MutexLock lock(mutex_);
  lock_at_ = now;
}

void Readiness::note_store(std::string trouble, Clock::time_point now) {
  const core::MutexLock lock(mutex_);
  store_trouble_ = std::move(trouble);
  store_at_ = now;
}

void Readiness::note_stop() {
  const core::MutexLock lock(mutex_);
  stops_ = true;
}

core::Status Readiness::status(Clock::time_point now) const {
  const auto not_ready = [](const std::string& why) {
    return core::Status(core::fail(core::ErrorCode::kUnavailable, "not ready: " + why));
  };
  const core::MutexLock lock(mutex_);
  if (stops_) return not_ready("the coordinator is stopping");
  if (now - lock_at_ > kLockWithin)
    return not_ready(fmt::format("the state lock was not available for {} s", kLockWithin.count()));
  if (!store_trouble_.empty()) return not_ready("the state cannot be written: " + store_trouble_);
  if (now - store_at_ > kStoreWithin)
    return not_ready(
        fmt::format("no checkpoint has ended for {} s: is the disk busy?", kStoreWithin.count()));
  return {};
}

}  // namespace tessera::rpc
