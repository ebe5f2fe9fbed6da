// SPDX-License-Identifier: Apache-2.0
// The workers that were heard of lately, and when each is due to lose its leases or to be forgotten. Not
// thread-safe.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "server/scheduler/events.hpp"
#include "server/scheduler/poison_tracker.hpp"
#include "server/scheduler/policy.hpp"
#include "server/scheduler/producer.hpp"
#include "server/scheduler/rate_meter.hpp"
#include "server/scheduler/types.hpp"
#include "server/scheduler/worker_state.hpp"

namespace tessera::scheduler {

// A lease as its holder's entry refers to it; what is in it, the job knows.
struct HeldLease {
  LeaseId id;
  JobId job;
  // Lease::alone.
  bool alone = false;
};

// What comes of a worker's leases of one job.
struct Effort {
  // It has held some since then (or given them back as they were, and taken others), and nothing that it
  // delivered has counted.
  Time no_progress_since{};
  // When it last gave one back before it was done.
  std::optional<Time> gave_back{};
  // How often in a row its leases have ended as STALLED, and until when it is given no others.
  int stalls = 0;
  Time cooldown_until{};
  // How often that was its own fault. Who is fetching the scene is excused, once.
  int faults = 0;
  bool exempt = false;
};

// A worker says that it renders what it has not any more, since it was at it for too long.
struct Stuck {
  Rendering rendering;
  // What was missing of that when it lost it; empty if it did not hold it.
  std::vector<WorkItem> items{};
  // Since when it is at it, and after what time that is held against the samples.
  Time since{};
  Duration counts_after{};
  bool struck = false;
};

struct Worker {
  WorkerInfo info;
  // Running number of who came when.
  std::uint64_t sequence = 0;
  Time last_seen{};
  // Its last Synchronize. Its leases run out lease_duration later.
  Time last_synchronized{};
  int wanted_leases = 0;
  // Oldest first.
  std::vector<HeldLease> leases;
  // What it said it holds in its last Synchronize, or was told of since with the answer to a result.
  std::set<LeaseId> reported;
  // Which jobs' files it said that it is fetching, and what it renders, since when.
  std::set<JobId> fetching;
  std::optional<Rendering> rendering;
  Time rendering_since{};
  // It is given nothing.
  std::optional<Stuck> stuck;
  // Others have delivered some of what it holds since its last reply.
  bool shrunk = false;
  // Its last reply was not `changed`, so that its call may be waiting.
  bool waiting = false;
  // Pixel samples per second, for each job it has rendered for.
  std::map<JobId, double> speed;
  // Work per second, on whatever job.
  Estimate pace;
  // When it last said that it cannot build a job's scene.
  std::map<JobId, Time> refused;
  // Of the jobs that it has held leases of.
  std::map<JobId, Effort> efforts;
  RateMeter rate;
  std::uint64_t samples_accepted = 0;
  // Ranges of it that others rendered again, and those of them that were wrong.
  std::uint64_t audited_ranges = 0, disproved_ranges = 0;

  Producer producer() const { return {info.name, info.id, info.machine}; }
  Loss loss(LossKind kind) const {
    return {.worker = info.id, .name = info.name, .kind = kind, .principal = info.principal};
  }
  WorkerState state() const { return state_; }
  bool takes_leases() const { return state_ == WorkerState::kPresent; }
  // The earliest time there is if it has built every scene.
  Time last_refusal() const;
  bool holds_any_of(const JobId& job) const;
  bool holds(LeaseId lease) const;
  // Its leases of the job have stalled, and nothing it delivered has counted since.
  bool has_stalled(const JobId& job) const;
  // It is given none of the job at this time, for that reason; or as long as it is fetching its files.
  bool in_cooldown(const JobId& job, Time now) const;
  bool awaits_files(const JobId& job) const { return has_stalled(job) && fetching.contains(job); }
  // It holds a lease that is to be its only one.
  bool holds_alone() const { return !leases.empty() && leases.front().alone; }
  // How many more leases it can be given.
  int room() const;
  WorkerSnapshot snapshot(const JobId& job) const;
  // Takes note of a measurement for a job; render_seconds must be positive.
  void measure(const JobId& job, std::uint64_t samples, double render_seconds);

 private:
  friend class WorkerRegistry;
  WorkerState state_ = WorkerState::kPresent;
};

class WorkerRegistry {
 public:
  WorkerRegistry(Duration lease_duration, Duration forget_after)
      : lease_duration_(lease_duration), forget_after_(forget_after) {}

  const std::map<WorkerId, Worker>& all() const { return workers_; }
  std::map<WorkerId, Worker>& all() { return workers_; }
  Worker* find(const WorkerId& id);
  const Worker* find(const WorkerId& id) const;

  // The worker has synchronised: enters it if it is new, and sets its deadline anew.
  Worker& heartbeat(const Synchronize& event, Time now);

  // When the leases of a worker that is not silent run out.
  Time deadline(const Worker& worker) const { return worker.last_synchronized + lease_duration_; }

  std::optional<Time> next_alarm() const;
  // Forgets who has been silent for long enough. Returns a worker whose deadline is not after `now`, if there
  // is one; the caller ends its leases, marks it lost, and calls again until nobody is returned.
  Worker* next_overdue(Time now);
  void mark_lost(Worker& worker);

  // How many take leases.
  int active_count() const { return active_count_; }

  // Whether something that workers of this name delivered has counted since one of them was last stuck.
  bool has_shown(const std::string& name) const { return shown_.contains(name); }
  void has_delivered(const std::string& name) {
    shown_.insert(name);
    kept_.erase(name);
  }
  void has_to_show_again(const std::string& name) {
    shown_.erase(name);
    kept_.erase(name);
  }
  // How long workers of this name that have ended were stuck, since then.
  Duration was_kept(const std::string& name) const {
    const auto kept = kept_.find(name);
    return kept == kept_.end() ? Duration::zero() : kept->second;
  }

 private:
  // The one way in which a worker's state changes; no change if it is in it already.
  void become(Worker& worker, WorkerState to);
  Time alarm(const Worker& worker) const;

  const Duration lease_duration_;
  const Duration forget_after_;
  std::map<WorkerId, Worker> workers_;
  // alarm() of every worker.
  std::set<std::pair<Time, WorkerId>> alarms_;
  int active_count_ = 0;
  std::uint64_t next_sequence_ = 0;
  std::set<std::string> shown_;
  std::map<std::string, Duration> kept_;
};

}  // namespace tessera::scheduler
