// SPDX-License-Identifier: Apache-2.0
#include "server/base/fair_pool.hpp"

#include <utility>

namespace tessera::base {

FairPool::FairPool(int threads, std::size_t max_waiting) : places_(max_waiting) {
  for (int i = 0; i < threads; ++i) threads_.emplace_back([this] { run(); });
}

FairPool::~FairPool() {
  {
    const core::MutexLock lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

bool FairPool::post(const std::string& caller, std::function<void()> task) {
  auto place = reserve(caller);
  if (!place) return false;
  post(caller, *std::move(place), std::move(task));
  return true;
}

void FairPool::post(const std::string& caller, FairShare::Held place, std::function<void()> task) {
  {
    const core::MutexLock lock(mutex_);
    std::deque<Task>& own = waiting_[caller];
    if (own.empty()) turns_.push_back(caller);
    own.push_back({std::move(task), std::move(place)});
  }
  changed_.notify_one();
}

void FairPool::run() {
  while (true) {
    core::MutexLock lock(mutex_);
    changed_.wait(lock.native(), [this]() TESSERA_REQUIRES(mutex_) { return stopping_ || !turns_.empty(); });
    if (turns_.empty()) return;
    const std::function<void()> work = take_next();
    lock.unlock();
    work();
  }
}

std::function<void()> FairPool::take_next() {
  std::string caller = std::move(turns_.front());
  turns_.pop_front();
  const auto own = waiting_.find(caller);
  std::function<void()> work = std::move(own->second.front().work);
  own->second.pop_front();
  if (own->second.empty()) {
    waiting_.erase(own);
  } else {
    turns_.push_back(std::move(caller));
  }
  return work;
}

}  // namespace tessera::base
