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

  // The first piece that is wanted: of one tile and one pass, as long as possible. Forgets the candidates
  // before it. Absent when nothing is wanted. Costs O(log n) for each candidate that is kept or forgotten.
  std::optional<WorkItem> next(const Wanted& wanted);

  // Forgets the first `count` samples of `piece`, which next() has just returned.
  void take(const WorkItem& piece, std::uint32_t count);

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
  std::optional<WorkItem> front() const;
  void forget_front(const WorkItem& front, std::uint32_t until);

  int tile_count_;
  std::uint32_t spp_;
  // The rest of this sample's pass in this tile, that pass in all later tiles, and all later passes are
  // candidates.
  Cursor cursor_;
  // By pass (its first sample) and tile; no set is empty. All lie before the cursor, so nothing is a
  // candidate twice.
  std::map<std::pair<std::uint32_t, int>, IntervalSet> returned_;
};

}  // namespace tessera::scheduler
