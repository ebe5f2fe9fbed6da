// SPDX-License-Identifier: Apache-2.0
// The exact sums of some samples of one tile. Parts of disjoint samples add up to the tile, in any order.
// Immutable while it is shared.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "core/film/film.hpp"
#include "core/film/layout.hpp"
#include "core/film/planes.hpp"
#include "core/film/sum_buffer.hpp"
#include "server/film/film_memory.hpp"
#include "server/scheduler/interval_set.hpp"

namespace tessera::film {

class TilePart {
 public:
  // Of no samples of these pixels. Its memory counts toward `memory`, which must outlive it.
  TilePart(std::shared_ptr<const core::FilmLayout> layout, const core::PixelRect& rect, FilmMemory& memory)
      : memory_(memory),
        layout_(std::move(layout)),
        rect_(rect),
        sums_(layout_->sums(rect.pixel_count())),
        odd_sums_(sums_.size()) {}
  TilePart(const TilePart& other);
  TilePart& operator=(const TilePart&) = delete;
  ~TilePart() { memory_.give_back(counted_bytes_); }

  // Each of these adds samples that it does not have. If there is no memory, it throws std::bad_alloc and
  // changes nothing.
  void add(const core::FilmTile& samples);
  void add(const TilePart& other);
  void add(const core::Film::TileSums& sums, const scheduler::IntervalSet& samples,
           const core::RenderCounters& counters);

  const scheduler::IntervalSet& samples() const { return samples_; }
  const core::RenderCounters& counters() const { return counters_; }
  core::Film::TileSums sums() const;
  // The same in the memory of an earlier result.
  void copy_to(core::Film::TileSums& sums) const;

 private:
  void add_sums(const std::vector<std::uint64_t>& sums, const std::vector<std::uint64_t>& odd_sums,
                const core::Planes& planes, const scheduler::IntervalSet& samples,
                const core::RenderCounters& counters);
  void count_memory();

  FilmMemory& memory_;
  const std::shared_ptr<const core::FilmLayout> layout_;
  const core::PixelRect rect_;
  std::uint64_t counted_bytes_ = 0;
  scheduler::IntervalSet samples_;
  core::SumBuffer sums_, odd_sums_;
  core::Planes planes_;
  core::RenderCounters counters_;
};

}  // namespace tessera::film
