// Samples of one job that dead workers held, and which workers: what may be killing them. Knows nothing of
// leases or time. Not thread-safe.
//
// A worker that dies may have been at any of the samples it held. So whatever it held is leased by itself
// from then on, to a worker that holds nothing else: another death then points at these samples, and those
// that are innocent are rendered and forgotten here.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "server/scheduler/types.hpp"

namespace tessera::scheduler {

// After so many deaths samples are leased one by one, so that the next one names the very one.
inline constexpr std::size_t kDeathsUntilSingleSamples = 2;
// So many deaths in a row, of workers with as many names, end the job.
inline constexpr std::size_t kDeathsUntilFailure = 3;

struct Death {
  WorkerId worker;
  // What people call it: its machine, which may run one process after the other, each a worker with an id of
  // its own.
  std::string name;
};

class Suspects {
 public:
  // The worker died while it held these samples. Each name counts once, however often its
  // workers die: something may be killing them there. One that did not hold them alone counts only if it was
  // the first: deaths are to be one after the other, not one partition of the network.
  void blame(const WorkItem& item, const Death& death, bool alone);
  // They have been rendered.
  void clear(const WorkItem& item);
  // The worker lives.
  void absolve(const WorkerId& worker);

  // The longest beginning of an item whose samples have the same deaths; none for samples under no suspicion.
  struct Part {
    core::SampleRange samples;
    std::vector<Death> deaths;
  };
  Part first_part(const WorkItem& item) const;

 private:
  // Of each tile in ascending order, disjoint; every one with deaths.
  std::map<int, std::vector<Part>> by_tile_;
};

}  // namespace tessera::scheduler
