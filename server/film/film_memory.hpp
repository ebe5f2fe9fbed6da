// SPDX-License-Identifier: Apache-2.0
// The memory of all films together: counts it, and frees tiles that the store has while it
// comes near its budget. Thread-safe.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <deque>
#include <memory>

#include "core/base/mutex.hpp"

namespace tessera::film {

class JobFilm;

class FilmMemory {
 public:
  explicit FilmMemory(std::uint64_t budget_bytes) : budget_bytes_(budget_bytes) {}

  // The memory of all samples and tiles.
  std::uint64_t used_bytes() const { return samples_bytes_ + tiles_ * kBytesPerTile; }
  std::uint64_t budget_bytes() const { return budget_bytes_; }
  // Whether films may take more samples. If not, the next checkpoint makes room.
  bool has_room() const { return samples_bytes_ < samples_budget(); }
  // Whether a checkpoint should be written soon, so that there are tiles to free.
  bool is_scarce() const { return samples_bytes_ > samples_budget() / 4 * 3; }
  // Whether tiles that the store has may stay in memory.
  bool may_keep_stored() const { return samples_bytes_ < samples_budget() / 8 * 5; }

  // What each tile of a film takes even if none of its samples is in memory.
  static constexpr std::uint64_t kBytesPerTile = 512;
  // Whether there is room for a film of so many tiles: at most half of the budget is for tiles as such.
  bool has_room_for(std::uint64_t tiles) const {
    return (tiles_ + tiles) * kBytesPerTile <= budget_bytes_ / 2;
  }
  void take_tiles(std::uint64_t tiles) { tiles_ += tiles; }
  void give_back_tiles(std::uint64_t tiles) { tiles_ -= tiles; }

  // Counts memory of samples.
  void take(std::uint64_t bytes) { samples_bytes_ += bytes; }
  void give_back(std::uint64_t bytes) { samples_bytes_ -= bytes; }

  void add(std::weak_ptr<JobFilm> film);
  // Frees the memory of stored tiles while there is no room to keep them.
  void free_stored();

 private:
  // What tiles as such leave of the budget: at least half, also if an earlier run admitted more of them.
  std::uint64_t samples_budget() const {
    return std::max(budget_bytes_ / 2,
                    budget_bytes_ - std::min<std::uint64_t>(budget_bytes_, tiles_ * kBytesPerTile));
  }
  // The films in turn; empty if there are none.
  std::shared_ptr<JobFilm> next_film();

  const std::uint64_t budget_bytes_;
  std::atomic<std::uint64_t> samples_bytes_{0}, tiles_{0};
  core::Mutex mutex_;
  std::deque<std::weak_ptr<JobFilm>> films_ TESSERA_GUARDED_BY(mutex_);  // some may be gone
};

}  // namespace tessera::film
