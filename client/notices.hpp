// SPDX-License-Identifier: Apache-2.0
// Warnings of background threads, for the thread that owns the terminal to print. Thread-safe.
#pragma once

#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace tessera::client {

class Notices {
 public:
  // Each message counts once.
  void add(const std::string& message) {
    const std::lock_guard lock(mutex_);
    if (told_.insert(message).second) waiting_.push_back(message);
  }

  // Those added since the last call.
  std::vector<std::string> take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(waiting_, {});
  }

 private:
  std::mutex mutex_;
  std::set<std::string> told_;
  std::vector<std::string> waiting_;
};

}  // namespace tessera::client
