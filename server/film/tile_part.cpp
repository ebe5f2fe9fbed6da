// SPDX-License-Identifier: Apache-2.0
#include "server/film/tile_part.hpp"

#include <span>

namespace tessera::film {

TilePart::TilePart(const TilePart& other)
    : memory_(other.memory_),
      layout_(other.layout_),
      rect_(other.rect_),
      samples_(other.samples_),
      sums_(other.sums_),
      odd_sums_(other.odd_sums_),
      planes_(other.planes_),
      counters_(other.counters_) {
  count_memory();
}

void TilePart::add(const core::FilmTile& samples) {
  add_sums(samples.sums, samples.odd_sums, samples.planes, {samples.range}, samples.counters);
}

void TilePart::add(const TilePart& other) {
  add_sums(other.sums_.values(), other.odd_sums_.values(), other.planes_, other.samples_, other.counters_);
}

void TilePart::add(const core::Film::TileSums& sums, const scheduler::IntervalSet& samples,
                   const core::RenderCounters& counters) {
  add_sums(sums.sums, sums.odd_sums, sums.planes, samples, counters);
}

void TilePart::add_sums(const std::vector<std::uint64_t>& sums, const std::vector<std::uint64_t>& odd_sums,
                        const core::Planes& planes, const scheduler::IntervalSet& samples,
                        const core::RenderCounters& counters) {
  scheduler::IntervalSet all = samples_;
  all.add(samples);
  core::Planes all_planes = planes_;
  if (!planes.empty()) core::add_planes(*layout_, all_planes, rect_, planes, rect_);
  sums_.reserve(0, sums);
  odd_sums_.reserve(0, odd_sums);
  sums_.add_reserved(0, sums);
  odd_sums_.add_reserved(0, odd_sums);
  planes_ = std::move(all_planes);
  samples_ = std::move(all);
  counters_.add(counters);
  count_memory();
}

void TilePart::count_memory() {
  std::uint64_t bytes = sums_.memory_bytes() + odd_sums_.memory_bytes();
  for (const core::Plane& plane : planes_) bytes += plane.capacity() * sizeof(plane[0]);
  memory_.take(bytes - counted_bytes_);  // modulo 2^64: planes may shrink
  counted_bytes_ = bytes;
}

core::Film::TileSums TilePart::sums() const {
  core::Film::TileSums result;
  copy_to(result);
  return result;
}

void TilePart::copy_to(core::Film::TileSums& to) const {
  sums_.copy_to(to.sums);
  odd_sums_.copy_to(to.odd_sums);
  to.planes = planes_;
  to.samples = to.odd_samples = 0;
  for (const core::SampleRange& range : samples_.ranges()) {
    to.samples += range.count();
    to.odd_samples += range.odd_count();
  }
}

}  // namespace tessera::film
