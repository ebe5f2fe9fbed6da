// SPDX-License-Identifier: Apache-2.0
// Scheduling policy: how much work to lease, and of which job. Pure functions of small snapshots.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "server/scheduler/types.hpp"

namespace tessera::scheduler {

struct SizingOptions {
  // The rendering time of a lease. Longer leases mean fewer messages; shorter ones lose less with a worker.
  double lease_seconds = 2.0;
  // The same for a worker of unknown speed, and the speed that it is assumed to have.
  double first_lease_seconds = 0.25;
  double assumed_samples_per_second_and_thread = 50'000;
  // Near the end, no lease exceeds 1 / (this * workers) of the rest (guided self-scheduling, Polychronopoulos
  // and Kuck 1987) …
  double end_divisor = 2.0;
  // … and none is shorter than this.
  double shortest_lease_seconds = 0.1;
};

struct WorkerSnapshot {
  int threads = 1;
  // Measured for the job in question, in pixel samples per second. Absent: unknown.
  std::optional<double> samples_per_second;
  // The same in pixel samples of the mean cost (TileCosts).
  std::optional<double> mean_samples_per_second{};
};

// The measured or assumed speed in pixel samples per second, and in those of the mean cost.
double expected_speed(const SizingOptions& options, const WorkerSnapshot& worker);
double expected_mean_speed(const SizingOptions& options, const WorkerSnapshot& worker);

// The size of a lease. Both numbers are at least 1 at first. Costly tiles reach the first one, so that a
// lease of them takes no longer than others. Cheap ones reach the second, which does not rely on what is
// known of tiles: a few wrong costs make no lease longer.
struct LeaseSize {
  double mean_samples = 1;  // pixel samples of the mean cost (TileCosts)
  double most_samples = 1;  // pixel samples
  bool is_used_up() const { return mean_samples < 1 || most_samples < 1; }
  bool operator==(const LeaseSize&) const = default;
};

// The size of the next lease, of `available` pixel samples, when `active_workers` (at least 1) share them.
// The last item of a lease may exceed it, since an item has at least one sample of each pixel of a tile.
LeaseSize next_lease_size(const SizingOptions& options, const WorkerSnapshot& worker, std::uint64_t available,
                          int active_workers);

// A value that is learnt from results; unknown before the first.
struct Estimate {
  double value = 0;
  std::uint64_t results = 0;
};

// The work of a pixel sample: the estimate, or the default for all jobs.
double cost_of(const SizingOptions& options, const Estimate& cost);
// Updates both estimates from the time of one sample. A known estimate determines the other one. If both are
// unknown, the worker is assumed to do one unit of work per second and thread. If both are known, each takes
// a part of the difference, so that a job costs the same whichever machines serve it. Reported times may be
// wrong or hostile: both estimates stay finite, so that later results can correct them.
void learn_cost(Estimate& cost, Estimate& pace, int threads, double seconds_per_sample);

// How long a worker may hold leases of a job and deliver nothing of it that counts: ten times the expected
// time of all that it holds, but at least ten and at most 360 lease durations (by default 100 s and an hour).
// The lower bound allows for fetching a scene, the upper one for a slow single sample of a tile.
Duration patience(Duration lease_duration, double expected_seconds);
// The maximum of patience().
Duration longest_patience(Duration lease_duration);

// The cooldown of a worker after this time on a job without progress: as long, doubled with each consecutive
// time.
Duration cooldown_after(Duration without_progress, int times_before);

struct JobSnapshot {
  int priority = 0;
  // The start of its next lease in virtual time, which advances for each job by the work leased (start-time
  // fair queueing, Goyal et al. 1996).
  double start = 0;
  // When it was last given a worker, as a sequence number; 0 for never.
  std::uint64_t last_served = 0;
};

// The index of the job to serve next: the one with the highest priority, then the earliest start, then the
// longest wait, then the first. All jobs must have work to lease, in the order of submission. `jobs` must not
// be empty.
std::size_t choose_job(std::span<const JobSnapshot> jobs);

// Whether a range is in the share (0 to 1) that is audited. It cannot be predicted without the secret.
bool chosen_for_audit(double share, std::uint64_t secret, const JobId& job, const WorkItem& item);

}  // namespace tessera::scheduler
