// SPDX-License-Identifier: Apache-2.0
#include "server/scaling/backlog_board.hpp"

namespace tessera::scaling {

void BacklogBoard::publish(const Backlog& backlog) {
  const core::MutexLock lock(mutex_);
  backlog_ = backlog;
  changed_.notify_all();
}

Backlog BacklogBoard::latest() const {
  const core::MutexLock lock(mutex_);
  return backlog_;
}

void BacklogBoard::close() {
  const core::MutexLock lock(mutex_);
  closed_ = true;
  changed_.notify_all();
}

bool BacklogBoard::is_closed() const {
  const core::MutexLock lock(mutex_);
  return closed_;
}

void BacklogBoard::wait_for_change(bool has_work, std::chrono::milliseconds longest) {
  core::MutexLock lock(mutex_);
  changed_.wait_for(lock.native(), longest,
                    [&]() TESSERA_REQUIRES(mutex_) { return closed_ || backlog_.has_work != has_work; });
}

}  // namespace tessera::scaling
