// SPDX-License-Identifier: Apache-2.0
#include "server/base/periodic.hpp"

#include <utility>

namespace tessera::base {

Periodic::Periodic(std::chrono::milliseconds period, std::function<void()> call)
    : period_(period), call_(std::move(call)) {
  thread_ = std::thread([this] {
    core::MutexLock lock(mutex_);
    for (;;) {
      changed_.wait_for(lock.native(), period_ / 4, [this]() TESSERA_REQUIRES(mutex_) { return stopping_; });
      changed_.wait_for(lock.native(), period_ - period_ / 4,
                        [this]() TESSERA_REQUIRES(mutex_) { return stopping_ || hurried_; });
      if (stopping_) return;
      hurried_ = false;
      lock.unlock();
      call_();
      lock.lock();
    }
  });
}

Periodic::~Periodic() {
  {
    const core::MutexLock lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Periodic::trigger() {
  {
    const core::MutexLock lock(mutex_);
    hurried_ = true;
  }
  changed_.notify_all();
}

}  // namespace tessera::base
