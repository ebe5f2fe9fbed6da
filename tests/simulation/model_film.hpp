// A film that only counts: for each tile and sample, how often it was added. Knows nothing of the scheduler's
// sets.
#pragma once

#include <cstdint>
#include <vector>

#include "server/scheduler/interval_set.hpp"
#include "server/scheduler/types.hpp"

namespace tessera::simulation {

class ModelFilm {
 public:
  ModelFilm() = default;
  explicit ModelFilm(const scheduler::JobShape& shape);

  void extend(std::uint32_t spp);
  // False if any of the samples was there already, or is none of the film's.
  bool add(const scheduler::WorkItem& item);
  bool complete() const;
  int tile_count() const { return static_cast<int>(tiles_.size()); }
  scheduler::IntervalSet done(int tile) const;

 private:
  std::vector<std::vector<bool>> tiles_;
};

}  // namespace tessera::simulation
