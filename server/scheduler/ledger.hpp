// SPDX-License-Identifier: Apache-2.0
// The producers of one job's samples, with fingerprints, until another worker has confirmed them. Knows no
// leases and no time. Not thread-safe.
//
// For images of 16K x 16K pixels: adjacent ranges of one producer become one entry, and beyond kMaxEntries
// only entries that are due are kept.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/scheduler/fingerprint.hpp"
#include "server/scheduler/producer.hpp"
#include "server/scheduler/tile_table.hpp"
#include "server/scheduler/types.hpp"

namespace tessera::scheduler {

// Whether another worker must render the range again, and why.
enum class Due : std::uint8_t {
  kNo,
  kChosen,   // chosen by lot
  kDoubted,  // the producer was quarantined, or two workers rendered different sums
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

  explicit Ledger(const JobGrid& grid) : grid_(grid), tiles_(grid.tile_count()) {}

  // The item must not overlap any entry.
  void add(const WorkItem& item, ProducerNumber producer, const Fingerprint& fingerprint, Due due);
  // The entry that begins at this sample. It must exist.
  const LedgerEntry& at(int tile, std::uint32_t begin) const;
  void set_due(int tile, std::uint32_t begin, Due due);
  void erase(int tile, std::uint32_t begin);
  void erase_tile(int tile);

  // In ascending order, disjoint.
  const std::vector<LedgerEntry>& of_tile(int tile) const { return tiles_[tile]; }
  int tile_count() const { return tiles_.tile_count(); }
  // The first tile from this one on that may have entries; tile_count() if there is none.
  int next_tile(int tile) const { return tiles_.next_written(tile); }
  // The pixel samples that are due.
  std::uint64_t due() const { return due_; }

 private:
  std::uint64_t pixel_samples(int tile, const LedgerEntry& entry) const;
  void merge_with_next(int tile, std::size_t left);
  LedgerEntry& mutable_at(int tile, std::uint32_t begin);

  JobGrid grid_;
  TileTable<std::vector<LedgerEntry>> tiles_;
  std::size_t entries_ = 0;
  std::uint64_t due_ = 0;
};

}  // namespace tessera::scheduler
