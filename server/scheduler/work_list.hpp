// SPDX-License-Identifier: Apache-2.0
// The candidate samples of a job in the order in which they should be leased: image by image, and in each
// image in passes of 1, 1, 2, 4, 8 … samples over all tiles, so that it has even quality at any moment.
// Samples that an extension adds come after those of all images. Samples stay candidates after they are done
// or leased: the caller filters each piece with Wanted. Not thread-safe.
//
// Samples that were never leased are those beyond a cursor, which takes no memory. Samples that were put back
// are stored individually, as are those beyond the target that most tiles have, and come at their place.
#pragma once

#include <compare>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>

#include "server/scheduler/interval_set.hpp"
#include "server/scheduler/types.hpp"

namespace tessera::scheduler {

// The pass to which a sample belongs: [0, 1), [1, 2), [2, 4), [4, 8) …
core::SampleRange pass_of(std::uint32_t sample);

class WorkList {
 public:
  // Returns the samples of this item that are neither done nor leased.
  using Wanted = std::function<IntervalSet(const WorkItem&)>;

  // All samples of the shape are candidates.
  explicit WorkList(const JobShape& shape);

  // Iterates over the candidates in order without changing them. Invalidated by any change of them.
  class Walk;

  // Removes the candidates before the first wanted piece.
  void forget_unwanted(const Wanted& wanted);

  // Removes all candidates.
  void clear();

  // Makes samples of the job candidates (again). They may be candidates already.
  void put_back(const WorkItem& item);

  // Makes the samples candidates by which this shape exceeds the last one. No target may be lower.
  void extend(const JobShape& shape);

  // All candidates of one tile, for checks.
  IntervalSet candidates(int tile) const;

 private:
  // A position in the order. Samples [round.begin, round.end) of all images are passed over first, and then
  // those up to the target that most tiles have. At the end the round is empty.
  struct Cursor {
    core::SampleRange round;
    int tile = 0;
    std::uint32_t sample = 0;
  };
  // Where a pass of a tile stands in the order.
  struct Place {
    int image = 0;
    std::uint32_t pass = 0;  // its first sample
    int tile = 0;
    auto operator<=>(const Place&) const = default;
  };

  Place place_of(int tile, std::uint32_t sample) const {
    return {grid_.image_of(tile), pass_of(sample).begin, tile};
  }
  // The first candidates at the cursor; empty if the tile has none in this pass and round.
  WorkItem at(const Cursor& cursor) const;
  // The position after this sample of the cursor's tile.
  Cursor after(Cursor cursor, std::uint32_t sample) const;
  // The first sample of this pass and tile that is not before the cursor.
  std::uint32_t passed_until(int tile, core::SampleRange pass) const;

  JobShape shape_;
  JobGrid grid_;
  // The candidates beyond the cursor: the rest of this sample's pass in this tile, that pass in all later
  // tiles of the image, its later passes, all later images, and all later rounds.
  Cursor cursor_;
  // Without empty sets. No sample is beyond the cursor as well, so none is a candidate twice.
  using Returned = std::map<Place, IntervalSet>;
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
  // Whether the next candidates are in returned_.
  bool is_at_returned() const;
  std::optional<WorkItem> front();
  // Continues from this sample of the piece that front() returned.
  void go_to(std::uint32_t sample);

  const WorkList& list_;
  // The positions: in returned_ from this sample on, and at the cursor. The one that comes first is next.
  Returned::const_iterator returned_;
  std::uint32_t returned_from_ = 0;
  Cursor cursor_;
};

}  // namespace tessera::scheduler
