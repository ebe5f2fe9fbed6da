// SPDX-License-Identifier: Apache-2.0
#include "server/store/group_commit.hpp"

#include <new>
#include <utility>

namespace tessera::store {

void GroupCommit::apply(std::span<PendingChange* const> group) noexcept {
  try {
    apply_(group);
  } catch (const std::bad_alloc&) {
    for (PendingChange* each : group)
      each->status = core::fail(core::ErrorCode::kResourceExhausted, "out of memory");
  }
}

core::Status GroupCommit::run(const std::function<core::Status()>& change) {
  PendingChange own{change};
  core::MutexLock lock(mutex_);
  waiting_.push_back(&own);
  changed_.wait(lock.native(), [&]() TESSERA_REQUIRES(mutex_) { return own.is_done || !is_busy_; });
  if (own.is_done) return std::move(own.status);
  is_busy_ = true;
  const std::vector<PendingChange*> group = std::exchange(waiting_, {});
  lock.unlock();
  apply(group);
  lock.lock();
  for (PendingChange* each : group) each->is_done = true;
  is_busy_ = false;
  ++groups_;
  lock.unlock();
  changed_.notify_all();
  return std::move(own.status);
}

core::Status GroupCommit::run_alone(const std::function<core::Status()>& work) {
  core::MutexLock lock(mutex_);
  changed_.wait(lock.native(), [&]() TESSERA_REQUIRES(mutex_) { return !is_busy_; });
  is_busy_ = true;
  lock.unlock();
  core::Status done = work();
  lock.lock();
  is_busy_ = false;
  lock.unlock();
  changed_.notify_all();
  return done;
}

std::uint64_t GroupCommit::groups() const {
  const core::MutexLock lock(mutex_);
  return groups_;
}

std::size_t GroupCommit::waiting() const {
  const core::MutexLock lock(mutex_);
  return waiting_.size();
}

}  // namespace tessera::store
