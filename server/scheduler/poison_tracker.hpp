// SPDX-License-Identifier: Apache-2.0
// Tracks samples of one job with which workers were lost, to find ranges that kill workers or never end.
// Knows no leases and no time. Not thread-safe.
//
// A worker that dies may have been rendering any of the samples it held. Each of its ranges is therefore
// leased alone from then on, to a worker that holds nothing else: another death then points at this range,
// and harmless ranges are rendered and cleared. A worker that is stuck reports the range itself.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "server/scheduler/types.hpp"

namespace tessera::scheduler {

// After so many losses, samples are leased one by one, so that the next loss identifies the sample.
inline constexpr std::size_t kLossesUntilSingleSamples = 2;
// So many consecutive losses, of workers with different names, fail the job.
inline constexpr std::size_t kLossesUntilFailure = 3;

enum class LossKind {
  kDied,   // its heartbeats stopped
  kStuck,  // it sends heartbeats, but renders the same samples for too long
};

// The loss of one worker.
struct Loss {
  WorkerId worker;
  // The worker's name: that of its machine, which may start several processes in succession, each a worker
  // with its own id.
  std::string name;
  LossKind kind = LossKind::kDied;
  // The worker was lost with exactly these samples, not with others of the same range.
  bool direct = true;
  // WorkerInfo::principal.
  std::string principal{};
};

class PoisonTracker {
 public:
  // Records that a worker was lost while it held these samples. Each name of each principal counts once. A
  // worker that died while it did not hold the samples alone counts only as the first loss: one network
  // partition must not count as several deaths. A stuck worker counts for all samples in which an earlier
  // worker was stuck and of which these are a part.
  void strike(const WorkItem& item, const Loss& loss, bool alone);
  // The samples were rendered: clears their losses.
  void clear(const WorkItem& item);
  // The worker was not lost in this way: it is alive, or renders something else.
  void withdraw_strikes(const WorkerId& worker, LossKind kind);
  // Whether there may be losses of this worker.
  bool may_name(const WorkerId& worker) const { return tiles_of_.contains(worker); }

  // The longest prefix of an item whose samples have the same losses; without losses for samples that are not
  // suspected.
  struct Part {
    core::SampleRange samples;
    std::vector<Loss> losses;
  };
  Part first_part(const WorkItem& item) const;
  // The range to report for an item: its first part. If not all workers were lost with exactly that part,
  // also the adjacent samples with which the same workers were lost.
  core::SampleRange to_be_told(const WorkItem& item) const;

 private:
  bool withdraw_from_tile(int tile, const WorkerId& worker, LossKind kind);
  static void spread(std::vector<Part>& parts, const WorkItem& item, const Loss& loss);

  // By tile: parts in ascending order, disjoint, each with losses.
  std::map<int, std::vector<Part>> by_tile_;
  // Contains every tile with losses of a worker; may contain others.
  std::map<WorkerId, std::set<int>> tiles_of_;
};

}  // namespace tessera::scheduler
