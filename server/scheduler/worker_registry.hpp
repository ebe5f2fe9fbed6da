// SPDX-License-Identifier: Apache-2.0
// The registered workers, and when each loses its leases or is forgotten. Not thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "server/scheduler/events.hpp"
#include "server/scheduler/poison_tracker.hpp"
#include "server/scheduler/policy.hpp"
#include "server/scheduler/producer.hpp"
#include "server/scheduler/rate_meter.hpp"
#include "server/scheduler/swept_map.hpp"
#include "server/scheduler/types.hpp"
#include "server/scheduler/worker_state.hpp"

namespace tessera::scheduler {

// A lease in its holder's entry; the job has its items.
struct HeldLease {
  LeaseId id;
  JobId job;
  JobNumber number = 0;
  RunNumber run = 0;
  // See Lease::alone.
  bool alone = false;
};

// A worker's progress with its leases of one job.
struct Effort {
  // Since then it has held leases (or given them back unchanged and taken others) without any result that
  // counted.
  Time no_progress_since{};
  // When it last gave one back unfinished.
  std::optional<Time> gave_back{};
  // How many times in a row its leases ended as STALLED, and when its cooldown ends.
  int stalls = 0;
  Time cooldown_until{};
  // How many of these were its own fault. A worker that fetches the scene is exempt, once.
  int faults = 0;
  bool exempt = false;

  // Its leases have stalled, and no result has counted since.
  bool has_stalled() const { return stalls > 0; }
  // Whether it is given no leases at this time because of that.
  bool in_cooldown(Time now) const { return has_stalled() && now < cooldown_until; }
};

// What is known of a worker and one run of a job.
struct JobNotes {
  // In pixel samples per second, and in pixel samples of the mean cost (TileCosts).
  std::optional<double> speed, mean_speed;
  // When the worker last reported that it cannot build the scene.
  std::optional<Time> refused;
  // If it has held leases.
  std::optional<Effort> effort;
};

// A worker reports that it renders samples that it lost because it took too long.
struct Stuck {
  Rendering rendering;
  // The missing samples of that when it lost them; empty if it did not hold them.
  std::vector<WorkItem> items{};
  // Since when it renders them, and after what time that counts against the samples.
  Time since{};
  Duration counts_after{};
  bool struck = false;
};

// The order in which waiting workers are offered new work. Idle workers come first: others would only queue
// the work. Then workers that have built every scene, or that failed to do so longest ago, so that the same
// ones do not take all places of a limited job. Then the order of registration: a range that kills workers so
// reaches every worker, since restarted ones come last.
struct WaitingRank {
  bool holds_leases = false;
  Time last_refusal{};
  std::uint64_t sequence = 0;
  auto operator<=>(const WaitingRank&) const = default;
};

struct Worker {
  WorkerInfo info;
  // A number in the order of registration.
  std::uint64_t sequence = 0;
  Time last_seen{};
  // The time of its last Synchronize. Its leases expire lease_duration later.
  Time last_synchronized{};
  int wanted_leases = 0;
  // Oldest first.
  std::vector<HeldLease> leases;
  // The leases that it reported in its last Synchronize, or was told of since with the answer to a result.
  std::set<LeaseId> reported;
  // The jobs whose files it reports to fetch, and what it reports to render, since when.
  std::set<JobId> fetching;
  std::optional<Rendering> rendering;
  Time rendering_since{};
  // Its last Synchronize said so, or an administrator wants it (Drain): either keeps it from new leases.
  bool reports_draining = false, drain_requested = false;
  // Its process must end, and whether a reply has said so.
  bool stop_requested = false, was_told_to_stop = false;
  // Present if it is stuck; it is given nothing then.
  std::optional<Stuck> stuck;
  // Others have delivered some of its samples since its last reply.
  bool shrunk = false;
  // Its last reply was not `changed`, so its call may be waiting.
  bool waiting = false;
  // Work per second, for all jobs.
  Estimate pace;
  // Those of runs that have ended are stale: they are never looked up, and swept out.
  SweptMap<RunNumber, JobNotes> notes;
  // JobNotes::refused of the runs in progress.
  std::set<std::pair<Time, RunNumber>> refusals;
  // Its place among the waiting workers, if it is one that could be given more (waiting_workers.hpp).
  std::optional<WaitingRank> waiting_rank;
  RateMeter rate;
  std::uint64_t samples_accepted = 0;
  // Its ranges that others audited, and those of them that were wrong.
  std::uint64_t audited_ranges = 0, disproved_ranges = 0;

  Producer producer() const { return producer_of(info); }
  Loss loss(LossKind kind) const {
    return {.worker = info.id, .name = info.name, .kind = kind, .principal = info.origin};
  }
  WorkerState state() const { return state_; }
  // Whether its samples are bit-compatible with those of a job; empty: it has none.
  bool fits(const std::string& fingerprint_of_job) const {
    const std::string& own = info.determinism_fingerprint;
    return fingerprint_of_job.empty() || own.empty() || own == fingerprint_of_job;
  }
  bool takes_leases() const { return state_ == WorkerState::kPresent; }
  // Takes leases, and is not stuck.
  bool is_available() const { return takes_leases() && !stuck; }
  WorkerActivity activity() const;
  WaitingRank rank() const;
  bool holds_any_of(JobNumber job) const;
  bool holds(LeaseId lease) const;
  // Null if it has held no lease of the run.
  const Effort* effort(RunNumber run) const;
  bool has_stalled(RunNumber run) const;
  // It holds a lease that must be its only one.
  bool holds_alone() const { return !leases.empty() && leases.front().alone; }
  // The number of further leases that it can be given.
  int room() const;
  WorkerSnapshot snapshot(RunNumber run) const;

 private:
  friend class WorkerRegistry;
  // As what it is counted among the available workers.
  struct Presence {
    std::string name, origin, machine;
    Identity identity;
    bool operator==(const Presence&) const = default;
  };

  WorkerState state_ = WorkerState::kPresent;
  std::optional<Presence> presence_;
  // As what it is counted among the workers that take leases.
  std::optional<Capabilities> counted_;
  // As what it is counted among all workers.
  std::optional<WorkerActivity> activity_;
};

// Records a measured speed; render_seconds must be positive.
void measure_speed(std::optional<double>& speed, double samples, double render_seconds);

class WorkerRegistry {
 public:
  WorkerRegistry(Duration lease_duration, Duration forget_after)
      : lease_duration_(lease_duration), forget_after_(forget_after) {}

  const std::map<WorkerId, Worker>& all() const { return workers_; }
  Worker* find(const WorkerId& id);
  const Worker* find(const WorkerId& id) const;

  // The worker has synchronised: registers it if it is new, and renews its deadline.
  Worker& heartbeat(const Synchronize& event, Time now);

  // When the leases of a worker that is not silent expire.
  Time deadline(const Worker& worker) const { return worker.last_synchronized + lease_duration_; }

  std::optional<Time> next_alarm() const;
  // A worker whose leases expire, or that is to be forgotten, not after `now`; null if there is none. The
  // caller marks it lost, when it has ended its leases, or forgets it.
  Worker* next_overdue(Time now);
  bool is_overdue(const Worker& worker, Time now) const { return alarm(worker) <= now; }
  void mark_lost(Worker& worker);
  // Removes a silent worker. Returns what was known of it, which may take long to destroy.
  std::shared_ptr<const void> forget(Worker& worker);
  void set_stuck(Worker& worker, std::optional<Stuck> stuck);
  // The worker may hold other leases than before.
  void count_activity(Worker& worker);
  void request_drain(Worker& worker, bool drain, bool stop);

  // The number of workers by what they do.
  const std::array<std::uint64_t, kWorkerActivities>& activities() const { return activities_; }
  bool any_draining() const { return activities_[static_cast<std::size_t>(WorkerActivity::kDraining)] > 0; }
  // The number of workers that take leases.
  int active_count() const { return active_count_; }
  // The same by capabilities, without empty entries; and whether those of any of them suffice for a job.
  const std::map<Capabilities, int>& active_by_capabilities() const { return active_; }
  bool any_active_for(const JobShape& job) const;
  // The available workers by identity, and their number by name and by WorkerInfo::origin. Without empty
  // entries.
  const std::map<Identity, std::set<WorkerId>>& available_by_identity() const { return available_; }
  const std::map<std::string, int>& available_by_name() const { return names_; }
  const std::map<std::string, int>& available_by_origin() const { return origins_; }
  // How often a worker has become available, or ceased to be, or changed its identity.
  std::uint64_t times_changed() const { return times_changed_; }

  // Whether a result of a worker of this name has counted since one of them was last stuck.
  bool has_shown(const std::string& name) const { return shown_.contains(name); }
  void has_delivered(const std::string& name) {
    shown_.insert(name);
    kept_.erase(name);
  }
  void has_to_show_again(const std::string& name) {
    shown_.erase(name);
    kept_.erase(name);
  }
  // The total time since then that workers of this name were stuck before they ended.
  Duration was_kept(const std::string& name) const {
    const auto kept = kept_.find(name);
    return kept == kept_.end() ? Duration::zero() : kept->second;
  }

 private:
  // The only function that changes a worker's state; no change if it is in it already.
  void become(Worker& worker, WorkerState to);
  // The state of a worker that is not silent.
  void settle_state(Worker& worker);
  void count_presence(Worker& worker);
  void count_active(Worker& worker);
  Time alarm(const Worker& worker) const;

  const Duration lease_duration_;
  const Duration forget_after_;
  std::map<WorkerId, Worker> workers_;
  // alarm() of every worker.
  std::set<std::pair<Time, WorkerId>> alarms_;
  int active_count_ = 0;
  std::map<Capabilities, int> active_;
  std::array<std::uint64_t, kWorkerActivities> activities_{};
  std::map<Identity, std::set<WorkerId>> available_;
  std::map<std::string, int> names_, origins_;
  std::uint64_t times_changed_ = 0;
  std::uint64_t next_sequence_ = 0;
  std::set<std::string> shown_;
  std::map<std::string, Duration> kept_;
};

}  // namespace tessera::scheduler
