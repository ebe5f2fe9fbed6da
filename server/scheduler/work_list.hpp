// SPDX-License-Identifier: Apache-2.0
// The samples of a job that might be leased, in the order in which they should be: passes of 1, 1, 2, 4, 8 …
// samples over all tiles, so that the picture is even at any moment. Holds candidates: who asks says of each
// piece what is really wanted of it, so that what was done or leased in another way need not be taken out.
// Not thread-safe.
//
// Never-leased candidates are everything beyond a cursor, which costs no memory; those that came back are
// kept one by one and go first.
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
  // What is neither done nor leased of these samples of this tile.
  using Wanted = std::function<IntervalSet(const WorkItem&)>;

  // Samples [0, spp) of every tile are candidates.
  WorkList(int tile_count, std::uint32_t spp);

  // A way through the candidates in their order, which leaves them as they are. Ends with any change of them.
  class Walk;

  // Forgets the candidates before the first piece that is wanted.
  void forget_unwanted(const Wanted& wanted);

  // Makes samples candidates (again). Within [0, spp); they may be so already.
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

  // The samples of this pass and tile that lie before the cursor end here.
  std::uint32_t passed_until(int tile, core::SampleRange pass) const;

  int tile_count_;
  std::uint32_t spp_;
  // The rest of this sample's pass in this tile, that pass in all later tiles, and all later passes are
  // candidates.
  Cursor cursor_;
  // By pass (its first sample) and tile; no set is empty. All lie before the cursor, so nothing is a
  // candidate twice.
  using Returned = std::map<std::pair<std::uint32_t, int>, IntervalSet>;
  Returned returned_;
};

class WorkList::Walk {
 public:
  explicit Walk(const WorkList& list)
      : list_(list), returned_(list.returned_.begin()), cursor_(list.cursor_) {}

  // The next piece that is wanted: of one tile and one pass, as long as possible. Absent when nothing more
  // is.
  std::optional<WorkItem> next(const Wanted& wanted);
  // Goes on behind the first `count` samples of `piece`, which next() has just returned.
  void pass(const WorkItem& piece, std::uint32_t count) { go_to(piece.samples.begin + count); }

 private:
  friend class WorkList;
  std::optional<WorkItem> front();
  // Goes on from this sample of what front() has returned.
  void go_to(std::uint32_t sample);

  const WorkList& list_;
  // Where it is: among what came back, from this sample of it; then at the cursor.
  Returned::const_iterator returned_;
  std::uint32_t returned_from_ = 0;
  Cursor cursor_;
};

}  // namespace tessera::scheduler
