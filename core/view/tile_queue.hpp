// SPDX-License-Identifier: Apache-2.0
// Which tile a viewer is sent next: first coarse ones from the centre outward, then those that it has not got
// at all, then those that were sent longest ago. Each tile is in the queue once, whatever happens to it
// meanwhile. Not thread-safe.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "core/film/region.hpp"
#include "core/view/tile_source.hpp"

namespace tessera::view {

class TileQueue {
 public:
  using Clock = std::chrono::steady_clock;
  // A viewer gets no tile more often.
  static constexpr std::chrono::milliseconds kMinInterval{100};

  // `centre`: of what the viewer looks at, in pixels of the whole image.
  TileQueue(const core::TileGrid& grid, int centre_x, int centre_y)
      : grid_(grid), centre_x_(centre_x), centre_y_(centre_y) {}

  // `with_coarse`: it is sent coarsely before. `is_first`: it had changed before the viewer came.
  void add(const TileChange& change, bool with_coarse, bool is_first);

  struct Next {
    TileChange change;
    bool is_coarse = false;
  };
  // Takes it out of the queue, but for a coarse one, which is to be sent finely, too. Nothing if there is
  // none that may be sent now.
  std::optional<Next> take(Clock::time_point now);
  // Whether the next one is a tile of which the viewer has got nothing in full yet.
  bool is_next_new() const { return next_time() == Clock::time_point{}; }
  // Changes of the tile up to this revision are sent.
  void note_sent(int tile, Revision revision, Clock::time_point now);

  // Whether all that was added as the first is sent.
  bool has_sent_first() const { return first_left_ == 0; }
  bool is_empty() const { return coarse_.empty() && fine_.empty(); }
  // When take() has something.
  std::optional<Clock::time_point> next_time() const;
  // Whoever has this revision gets all that is not sent, where `seen` is the last change that was added.
  Revision complete_until(Revision seen) const;

 private:
  struct Entry {
    Revision last = 0, sent = 0;
    Clock::time_point sent_at{};
    bool is_waiting = false;
    bool is_first = false;  // and not sent yet
  };
  using Distance = std::int64_t;

  Distance distance(int tile) const;

  const core::TileGrid grid_;
  const int centre_x_, centre_y_;
  std::map<int, Entry> entries_;
  std::size_t first_left_ = 0;  // entries that are first
  std::set<std::pair<Distance, int>> coarse_;
  std::set<std::tuple<Clock::time_point, Distance, int>> fine_;  // by when they were sent
};

}  // namespace tessera::view
