// SPDX-License-Identifier: Apache-2.0
// The candidate samples of a job in the order in which they should be leased: passes of 1, 1, 2, 4, 8 …
// samples over all tiles, so that the image has even quality at any moment. Samples stay candidates after
// they are done or leased: the caller filters each piece with Wanted. Not thread-safe.
//
// Samples that were never leased are those beyond a cursor, which takes no memory. Samples that were put back
// are stored individually and come first.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <utility>

#include "server/scheduler/interval_set.hpp"
#include "server/scheduler/types.hpp"

namespace tessera::scheduler {

// The pass to which a sample belongs: [0, 1), [1, 2), [2, 4), [4, 8) …
core::SampleRange pass_of(std::uint32_t sample);

class WorkList {
 public:
  // Returns the samples of this item that are neither done nor leased.
  using Wanted = std::function<IntervalSet(const WorkItem&)>;

  // Samples [0, spp) of every tile are candidates.
  WorkList(int tile_count, std::uint32_t spp);

  // Iterates over the candidates in order without changing them. Invalidated by any change of them.
  class Walk;

  // Removes the candidates before the first wanted piece.
  void forget_unwanted(const Wanted& wanted);

  // Removes all candidates.
  void clear();

  // Makes samples candidates (again). They must lie in [0, spp), and may be candidates already.
  void put_back(const WorkItem& item);

  // Makes samples [old spp, spp) of every tile candidates. Never lowers spp.
  void extend(std::uint32_t spp);

  // All candidates of one tile, for checks.
  IntervalSet candidates(int tile) const;

 private:
  struct Cursor {
    int tile = 0;
    std::uint32_t sample = 0;
  };

  // The first sample of this pass and tile that is not before the cursor.
  std::uint32_t passed_until(int tile, core::SampleRange pass) const;

  int tile_count_;
  std::uint32_t spp_;
  // The candidates beyond the cursor: the rest of this sample's pass in this tile, that pass in all later
  // tiles, and all later passes.
  Cursor cursor_;
  // By pass (its first sample) and tile, without empty sets. All lie before the cursor, so no sample is a
  // candidate twice.
  using Returned = std::map<std::pair<std::uint32_t, int>, IntervalSet>;
  Returned returned_;
};

class WorkList::Walk {
 public:
  explicit Walk(const WorkList& list)
      : list_(list), returned_(list.returned_.begin()), cursor_(list.cursor_) {}

  // The next wanted piece, of one tile and one pass, as long as possible. Empty at the end.
  std::optional<WorkItem> next(const Wanted& wanted);
  // Continues after the first `count` samples of `piece`, which next() has just returned.
  void pass(const WorkItem& piece, std::uint32_t count) { go_to(piece.samples.begin + count); }

 private:
  friend class WorkList;
  std::optional<WorkItem> front();
  // Continues from this sample of the piece that front() returned.
  void go_to(std::uint32_t sample);

  const WorkList& list_;
  // The position: in returned_ from this sample on, and then at the cursor.
  Returned::const_iterator returned_;
  std::uint32_t returned_from_ = 0;
  Cursor cursor_;
};

}  // namespace tessera::scheduler
