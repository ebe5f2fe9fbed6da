// SPDX-License-Identifier: Apache-2.0
// Group commit: changes that arrive while a transaction is being written share the next one, and with it the
// wait for the disk. The first waiting caller writes for all of them. Thread-safe.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/mutex.hpp"

namespace tessera::store {

// A change of the database, and what became of it.
struct PendingChange {
  const std::function<core::Status()>& change;
  core::Status status{};
  bool is_done = false;
};

class GroupCommit {
 public:
  // Applies the changes of a group in one transaction, and sets the status of each. One call at a time.
  using Apply = std::function<void(std::span<PendingChange* const>)>;

  explicit GroupCommit(Apply apply) : apply_(std::move(apply)) {}

  // Blocks until a transaction with the change is written, or has failed. RESOURCE_EXHAUSTED if there is no
  // memory.
  core::Status run(const std::function<core::Status()>& change);
  // Runs something between two groups. It must not call run().
  core::Status run_alone(const std::function<core::Status()>& work);

  // The number of groups so far.
  std::uint64_t groups() const;
  // The changes that wait for the next group.
  std::size_t waiting() const;

 private:
  void apply(std::span<PendingChange* const> group) noexcept;

  const Apply apply_;
  mutable core::Mutex mutex_;
  std::condition_variable changed_;
  std::vector<PendingChange*> waiting_ TESSERA_GUARDED_BY(mutex_);
  bool is_busy_ TESSERA_GUARDED_BY(mutex_) = false;
  std::uint64_t groups_ TESSERA_GUARDED_BY(mutex_) = 0;
};

}  // namespace tessera::store
