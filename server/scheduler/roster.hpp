// The workers that were heard of lately, and when each is due to lose its leases or to be forgotten. Not
// thread-safe.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "server/scheduler/author.hpp"
#include "server/scheduler/events.hpp"
#include "server/scheduler/policy.hpp"
#include "server/scheduler/rate_meter.hpp"
#include "server/scheduler/types.hpp"

namespace tessera::scheduler {

// A lease as its holder's entry refers to it; what is in it, the job knows.
struct HeldLease {
  LeaseId id;
  JobId job;
  // The worker has reported it, so it knows of it. Until then the reply with it may have been lost, or be on
  // its way.
  bool acknowledged = false;
  // Lease::alone.
  bool alone = false;
};

struct Worker {
  WorkerInfo info;
  // Running number of who came when.
  std::uint64_t arrival = 0;
  Time last_seen{};
  // Its last Synchronize. Its leases run out lease_duration later.
  Time last_synchronized{};
  bool draining = false;
  bool silent = false;
  int wanted_leases = 0;
  // Oldest first.
  std::vector<HeldLease> leases;
  // What it said it holds in its last Synchronize.
  std::set<LeaseId> reported;
  // Others have delivered some of what it holds since its last reply.
  bool shrunk = false;
  // Its last reply was not `changed`, so that its call may be waiting.
  bool waiting = false;
  // Pixel samples per second, for each job it has rendered for.
  std::map<JobId, double> speed;
  // When it last said that it cannot build a job's scene.
  std::map<JobId, Time> refused;
  RateMeter rate;
  std::uint64_t samples_accepted = 0;
  // Ranges of it that others rendered again, and those of them that were wrong.
  std::uint64_t audited_ranges = 0, disproved_ranges = 0;

  Author author() const { return {info.name, info.id}; }
  bool takes_leases() const { return !draining && !silent; }
  // The earliest time there is if it has built every scene.
  Time last_refusal() const;
  // It holds a lease that is to be its only one.
  bool holds_alone() const { return !leases.empty() && leases.front().alone; }
  // How many more leases it can be given.
  int room() const;
  WorkerSnapshot snapshot(const JobId& job) const;
  // Takes note of a measurement for a job; render_seconds must be positive.
  void measure(const JobId& job, std::uint64_t samples, double render_seconds);
};

class Roster {
 public:
  Roster(Duration lease_duration, Duration forget_after)
      : lease_duration_(lease_duration), forget_after_(forget_after) {}

  const std::map<WorkerId, Worker>& all() const { return workers_; }
  std::map<WorkerId, Worker>& all() { return workers_; }
  Worker* find(const WorkerId& id);
  const Worker* find(const WorkerId& id) const;

  // The worker has synchronised: enters it if it is new, and sets its deadline anew.
  Worker& hear(const Synchronize& event, Time now);

  // When the leases of a worker that is not silent run out.
  Time deadline(const Worker& worker) const { return worker.last_synchronized + lease_duration_; }

  std::optional<Time> next_alarm() const;
  // Forgets who has been silent for long enough. If a deadline is not after `now`, marks its worker as silent
  // and returns it; the caller ends its leases, and calls again until nobody is returned.
  Worker* next_silent(Time now);

  // How many take leases.
  int active_count() const { return active_count_; }

 private:
  Time alarm(const Worker& worker) const;

  const Duration lease_duration_;
  const Duration forget_after_;
  std::map<WorkerId, Worker> workers_;
  // alarm() of every worker.
  std::set<std::pair<Time, WorkerId>> alarms_;
  int active_count_ = 0;
  std::uint64_t arrivals_ = 0;
};

}  // namespace tessera::scheduler
