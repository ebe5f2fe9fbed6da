// SPDX-License-Identifier: Apache-2.0
#include "server/film/tile_part.hpp"

#include <span>

namespace tessera::film {

TilePart::TilePart(const TilePart& other)
    : memory_(other.memory_),
      samples_(other.samples_),
      sums_(other.sums_),
      odd_sums_(other.odd_sums_),
      counters_(other.counters_) {
  count_memory();
}

void TilePart::add(const core::FilmTile& samples) {
  add_sums(samples.sums, samples.odd_sums, {samples.range}, samples.counters);
}

void TilePart::add(const TilePart& other) {
  add_sums(other.sums_.values(), other.odd_sums_.values(), other.samples_, other.counters_);
}

void TilePart::add(const core::Film::TileSums& sums, const scheduler::IntervalSet& samples,
                   const core::RenderCounters& counters) {
  add_sums(sums.sums, sums.odd_sums, samples, counters);
}

template <typename Sums>
void TilePart::add_sums(const Sums& sums, const Sums& odd_sums, const scheduler::IntervalSet& samples,
                        const core::RenderCounters& counters) {
  scheduler::IntervalSet all = samples_;
  all.add(samples);
  sums_.reserve(0, sums);
  odd_sums_.reserve(0, odd_sums);
  sums_.add(0, sums);
  odd_sums_.add(0, odd_sums);
  samples_ = std::move(all);
  counters_.add(counters);
  count_memory();
}

void TilePart::count_memory() {
  const std::uint64_t bytes = sums_.memory_bytes() + odd_sums_.memory_bytes();
  memory_.take(bytes - counted_bytes_);  // it never shrinks
  counted_bytes_ = bytes;
}

core::Film::TileSums TilePart::sums() const {
  core::Film::TileSums result{sums_.values(), odd_sums_.values(), 0, 0};
  for (const core::SampleRange& range : samples_.ranges()) {
    result.samples += range.count();
    result.odd_samples += range.odd_count();
  }
  return result;
}

}  // namespace tessera::film
