// SPDX-License-Identifier: Apache-2.0
#include "server/base/thread_pool.hpp"

#include <utility>

namespace tessera::base {

ThreadPool::ThreadPool(int threads, std::size_t max_waiting) : max_waiting_(max_waiting) {
  for (int i = 0; i < threads; ++i) threads_.emplace_back([this] { run(); });
}

ThreadPool::~ThreadPool() {
  {
    const core::MutexLock lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

bool ThreadPool::post(std::function<void()> task) {
  {
    const core::MutexLock lock(mutex_);
    if (waiting_.size() >= max_waiting_) return false;
    waiting_.push_back(std::move(task));
  }
  changed_.notify_one();
  return true;
}

std::size_t ThreadPool::waiting() const {
  const core::MutexLock lock(mutex_);
  return waiting_.size();
}

bool ThreadPool::run_or_post(std::function<void()> task) {
  if (waiting() > 0 || runs_at_caller_.test_and_set()) return post(std::move(task));
  [&]() noexcept { task(); }();
  runs_at_caller_.clear();
  return true;
}

void ThreadPool::run() {
  while (true) {
    core::MutexLock lock(mutex_);
    changed_.wait(lock.native(),
                  [this]() TESSERA_REQUIRES(mutex_) { return stopping_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    const std::function<void()> task = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    task();
  }
}

}  // namespace tessera::base
