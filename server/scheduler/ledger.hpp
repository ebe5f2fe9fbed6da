// SPDX-License-Identifier: Apache-2.0
// Who has rendered which samples of one job, with their fingerprints, as far as nobody else has confirmed
// them. Knows nothing of leases or time. Not thread-safe.
//
// Made for pictures of 16K x 16K pixels: neighbouring ranges of one author become one entry, and beyond
// kMaxEntries nothing is noted but what is due.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/scheduler/fingerprint.hpp"
#include "server/scheduler/producer.hpp"
#include "server/scheduler/types.hpp"

namespace tessera::scheduler {

// Whether another worker is to render it again, and why.
enum class Due : std::uint8_t {
  kNo,
  kChosen,   // by lot
  kDoubted,  // its author was quarantined, or two workers have rendered other bits
};

struct LedgerEntry {
  core::SampleRange samples;
  std::uint64_t low = 0, high = 0;
  float largest = 0;
  ProducerNumber producer : 30 = 0;
  unsigned due_bits : 2 = 0;

  Fingerprint fingerprint() const { return {low, high, largest}; }
  Due due() const { return static_cast<Due>(due_bits); }
};
static_assert(sizeof(LedgerEntry) == 32);

class Ledger {
 public:
  static constexpr std::size_t kMaxEntries = std::size_t{5} << 18;  // 40 MiB

  explicit Ledger(const core::TileGrid& grid)
      : grid_(grid), tiles_(static_cast<std::size_t>(grid.tile_count())) {}

  // The item must overlap no entry.
  void add(const WorkItem& item, ProducerNumber producer, const Fingerprint& fingerprint, Due due);
  // The entry that begins at this sample, which must be there.
  const LedgerEntry& at(int tile, std::uint32_t begin) const;
  void set_due(int tile, std::uint32_t begin, Due due);
  void erase(int tile, std::uint32_t begin);
  void erase_tile(int tile);
  void clear();

  // In ascending order, disjoint.
  const std::vector<LedgerEntry>& of_tile(int tile) const { return tiles_[static_cast<std::size_t>(tile)]; }
  int tile_count() const { return static_cast<int>(tiles_.size()); }
  // In pixel samples.
  std::uint64_t due() const { return due_; }

 private:
  std::uint64_t pixel_samples(int tile, const LedgerEntry& entry) const;
  void merge_with_next(int tile, std::size_t left);
  LedgerEntry& mutable_at(int tile, std::uint32_t begin);

  core::TileGrid grid_;
  std::vector<std::vector<LedgerEntry>> tiles_;
  std::size_t entries_ = 0;
  std::uint64_t due_ = 0;
};

}  // namespace tessera::scheduler
