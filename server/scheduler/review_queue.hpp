// SPDX-License-Identifier: Apache-2.0
// The jobs that are still to be searched for samples of distrusted workers, and from which tile on. A search
// of many or large jobs is spread over several events. Not thread-safe.
#pragma once

#include <map>
#include <optional>

#include "server/scheduler/types.hpp"

namespace tessera::scheduler {

class ReviewQueue {
 public:
  // All jobs from the first to this one, from their first tile.
  void add_all(JobNumber last) { all_ = Pass{.last = last}; }
  // A job that is to run again if samples are found. Comes before the others.
  void add(JobNumber job) { reopened_[job] = 0; }
  void remove(JobNumber job) { reopened_.erase(job); }

  bool empty() const { return reopened_.empty() && !all_; }
  bool contains(JobNumber job) const {
    return reopened_.contains(job) || (all_ && all_->job <= job && job <= all_->last);
  }

  struct Position {
    // The next job in the queue has this number or a higher one.
    JobNumber job = 0;
    int tile = 0;
    bool reopened = false;
  };
  // The queue must not be empty.
  Position next() const {
    if (!reopened_.empty()) return {reopened_.begin()->first, reopened_.begin()->second, true};
    return {all_->job, all_->tile};
  }
  // The search goes on with this tile of this job.
  void continue_at(const Position& position) {
    if (position.reopened) {
      reopened_[position.job] = position.tile;
    } else {
      all_->job = position.job;
      all_->tile = position.tile;
    }
  }
  // The job is searched; absent: there is none with such a number.
  void finish(bool reopened, std::optional<JobNumber> job) {
    if (reopened) return remove(*job);
    if (!job || *job >= all_->last) return all_.reset();
    all_->job = *job + 1;
    all_->tile = 0;
  }

 private:
  struct Pass {
    JobNumber job = 0;
    int tile = 0;
    JobNumber last = 0;
  };

  // By number, with the next tile.
  std::map<JobNumber, int> reopened_;
  std::optional<Pass> all_;
};

}  // namespace tessera::scheduler
