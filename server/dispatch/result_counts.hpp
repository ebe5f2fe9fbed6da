// SPDX-License-Identifier: Apache-2.0
// Counts the results of workers that were not counted toward a job. Lock-free; thread-safe.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace tessera::dispatch {

enum class RejectedFor {
  kMalformed,    // a text or an item that cannot be read, or samples that no renderer gives
  kToken,        // no proof that the lease was given to the worker
  kFilmMemory,   // no memory for more samples until a checkpoint is written
  kMemory,       // no memory at all
  kPrincipal,    // the worker is registered by another caller
  kQuarantine,   // the worker is quarantined
  kFingerprint,  // not bit-compatible with the job
  kLease,        // items that are not of the lease or the job
};
inline constexpr std::size_t kRejectionReasons = 8;

// "malformed", "token", …, for labels.
constexpr std::string_view rejection_name(RejectedFor reason) {
  constexpr std::array<std::string_view, kRejectionReasons> kNames{
      "malformed", "token", "film_memory", "memory", "principal", "quarantine", "fingerprint", "lease"};
  return kNames[static_cast<std::size_t>(reason)];
}

class ResultCounts {
 public:
  void note(RejectedFor reason) { ++rejected_[static_cast<std::size_t>(reason)]; }
  void note_items_of_unknown_job(std::uint64_t items) { items_of_unknown_jobs_ += items; }

  std::uint64_t rejected(RejectedFor reason) const { return rejected_[static_cast<std::size_t>(reason)]; }
  // Items of jobs that were deleted, or never existed.
  std::uint64_t items_of_unknown_jobs() const { return items_of_unknown_jobs_; }

 private:
  std::array<std::atomic<std::uint64_t>, kRejectionReasons> rejected_{};
  std::atomic<std::uint64_t> items_of_unknown_jobs_{0};
};

}  // namespace tessera::dispatch
