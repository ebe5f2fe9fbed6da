// SPDX-License-Identifier: Apache-2.0
// Samples of one job that workers were lost with, and which workers: what may be killing them, or never comes
// to an end. Knows nothing of leases or time. Not thread-safe.
//
// A worker that dies may have been at any of the samples it held. So whatever it held is leased by itself
// from then on, to a worker that holds nothing else: another death then points at these samples, and those
// that are innocent are rendered and forgotten here. One that is stuck says what it is at.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "server/scheduler/types.hpp"

namespace tessera::scheduler {

// After so many losses samples are leased one by one, so that the next one names the very one.
inline constexpr std::size_t kLossesUntilSingleSamples = 2;
// So many losses in a row, of workers with as many names, end the job.
inline constexpr std::size_t kLossesUntilFailure = 3;

enum class LossKind {
  kDied,   // it is heard of no more
  kStuck,  // it is heard of, and renders the same samples for ever
};

// A worker that a job has cost.
struct Loss {
  WorkerId worker;
  // What people call it: its machine, which may run one process after the other, each a worker with an id of
  // its own.
  std::string name;
  LossKind kind = LossKind::kDied;
  // With the samples that have it, not with others of the same range.
  bool direct = true;
  // WorkerInfo::principal.
  std::string principal{};
};

class PoisonTracker {
 public:
  // The worker was lost while it held these samples. Each name of each principal counts once, however often
  // its workers are lost: something may be killing them there. One that died and did not hold them alone
  // counts only if it was the first: deaths are to be one after the other, not one partition of the network.
  // Who is stuck counts for all samples that an earlier one was stuck in, of which these are a part.
  void strike(const WorkItem& item, const Loss& loss, bool alone);
  // They have been rendered.
  void clear(const WorkItem& item);
  // The worker was not lost in this way: it lives, or goes on to something else.
  void withdraw_strikes(const WorkerId& worker, LossKind kind);

  // The longest beginning of an item whose samples have the same losses; none for samples under no suspicion.
  struct Part {
    core::SampleRange samples;
    std::vector<Loss> losses;
  };
  Part first_part(const WorkItem& item) const;
  // What to tell of an item: its first part, or the samples around that, without gaps, with which the same
  // workers were lost, if they were not all lost with that part itself.
  core::SampleRange to_be_told(const WorkItem& item) const;

 private:
  static void spread(std::vector<Part>& parts, const WorkItem& item, const Loss& loss);

  // Of each tile in ascending order, disjoint; every one with losses.
  std::map<int, std::vector<Part>> by_tile_;
};

}  // namespace tessera::scheduler
