// SPDX-License-Identifier: Apache-2.0
// The scheduler's judgement: how much work to hand out, and of which job. Pure functions of small snapshots.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "server/scheduler/types.hpp"

namespace tessera::scheduler {

struct SizingOptions {
  // What a lease should keep its worker busy for. Longer: less traffic. Shorter: less lost with a worker.
  double lease_seconds = 2.0;
  // The same for a worker whose speed is not known yet, and the speed it is taken to have.
  double first_lease_seconds = 0.25;
  double assumed_samples_per_second_and_thread = 50'000;
  // Towards the end no lease is more than 1 / (this * workers) of what is left (guided self-scheduling,
  // Polychronopoulos and Kuck 1987) …
  double end_divisor = 2.0;
  // … but not less than this either.
  double shortest_lease_seconds = 0.1;
};

struct WorkerSnapshot {
  int threads = 1;
  // For the job in question, in pixel samples per second. Absent: never measured.
  std::optional<double> samples_per_second;
};

// Pixel samples per second: as measured, or as assumed.
double expected_speed(const SizingOptions& options, const WorkerSnapshot& worker);

// How many pixel samples the next lease should have, of `available` that could be leased, when
// `active_workers` (at least 1) share them. At least 1. The last item of a lease may go beyond it: an item is
// at least one sample of a tile.
std::uint64_t next_lease_samples(const SizingOptions& options, const WorkerSnapshot& worker,
                                 std::uint64_t available, int active_workers);

// A number that results tell; unknown before the first.
struct Estimate {
  double value = 0;
  std::uint64_t results = 0;
};

// The work of a pixel sample: what is known of it, or what all jobs are taken to cost.
double cost_of(const SizingOptions& options, const Estimate& cost);
// A sample of a job took a worker so many seconds. What is known of one tells of the other; where neither is,
// the worker is taken to do a second's work in a second of each thread; where both are, the difference is put
// down to both, so that a job costs the same whichever machines serve it. Whatever workers say, both stay
// numbers that others can mend.
void learn_cost(Estimate& cost, Estimate& pace, int threads, double seconds_per_sample);

// How long a worker may hold leases of a job and deliver nothing of it that counts: ten times as long as all
// that it holds should take it, but not less than ten lease durations, nor more than 360 (by default 100 s
// and an hour). A scene may have to be fetched first, and a single sample of a tile is as long as it is.
Duration patience(Duration lease_duration, double expected_seconds);
// The most that patience() is.
Duration longest_patience(Duration lease_duration);

// How long a worker that was at a job for so long, without progress, is given no more of it: as long, and twice as
// long each further time in a row.
Duration cooldown_after(Duration without_progress, int times_before);

struct JobSnapshot {
  int priority = 0;
  // Where its next lease would begin in virtual time, in which each job goes on by the work that it is
  // given (start-time fair queueing, Goyal et al. 1996).
  double start = 0;
  // When it was last given a worker, as a running number; 0 for never.
  std::uint64_t last_served = 0;
};

// Which of the jobs (all with work to give, in the order of submission) is served next: the highest priority,
// of those the earliest start, of those the one that has waited longest, of those the first. `jobs` must not
// be empty.
std::size_t choose_job(std::span<const JobSnapshot> jobs);

// Whether a range is one of the share (0 to 1) that is rendered again. Nobody who does not know the secret
// can tell which ones are.
bool chosen_for_audit(double share, std::uint64_t secret, const JobId& job, const WorkItem& item);

}  // namespace tessera::scheduler
