// SPDX-License-Identifier: Apache-2.0
// What the users of a scheduler see of its jobs and workers. Plain values.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/scheduler/events.hpp"
#include "server/scheduler/job_state.hpp"
#include "server/scheduler/types.hpp"

namespace tessera::scheduler {

// Why a job waits for its first worker, or gets no more workers.
enum class Waiting {
  kNo,
  kPaused,
  kNoWorker,        // no worker is connected
  kDraining,        // all connected workers drain
  kNoImages,        // no such worker knows jobs of several images
  kNoLayers,        // no such worker renders layers
  kHigherPriority,  // jobs of higher priority have work
  kTurn,            // it is served next, or after others of its priority
  kVerification,    // it lacks only verification, for which no worker is free
  kMaxWorkers,      // it has as many workers as it may have
};

// All counts are in pixel samples.
struct JobView {
  JobId id;
  JobShape shape;
  int priority = 0;
  JobState state = JobState::kRunning;
  std::string failure;
  std::uint64_t samples_done = 0;
  std::uint64_t samples_total = 0;
  // Over the last seconds and all workers; 0 if unknown.
  double samples_per_second = 0;
  // The workers that hold a lease of it.
  int active_workers = 0;
  // The limit on active_workers; 0 for none.
  std::uint32_t max_workers = 0;
  // The part of samples_done that another worker must render again.
  std::uint64_t samples_to_verify = 0;
  // Empty unless the state is kFailed.
  FailureDetails failure_details{};
  Waiting waiting = Waiting::kNo;
  // Its place among the jobs that have samples to lease, from 1, if it waits for its first worker.
  std::uint32_t queue_position = 0;
};

// A part of a lease: a tile of which somebody renders samples.
struct LeasedTile {
  int tile = 0;
  WorkerId holder;
};
// Some of a job's leases.
struct LeasePage {
  std::vector<LeasedTile> tiles;
  // The last lease of the page; absent if there are no further ones.
  std::optional<LeaseId> last;
};

// A job of which a worker is given no leases for a while, since its leases of it have stalled.
struct CooldownView {
  JobId job;
  Duration remaining{};
  // The cooldown lasts while the worker reports that it fetches the job's files.
  bool fetching = false;
};

struct WorkerView {
  WorkerInfo info;
  int held_leases = 0;
  // Over the last seconds; 0 if unknown.
  double samples_per_second = 0;
  // The pixel samples that were accepted from it.
  std::uint64_t samples_accepted = 0;
  // The time of its last Synchronize or SubmitResult.
  Time last_seen{};
  bool draining = false;
  // An administrator wants it to take no more leases (Drain).
  bool drain_requested = false;
  // It has not synchronised for lease_duration: it holds nothing, and is listed until forget_after.
  bool silent = false;
  // See Worker.
  std::uint64_t audited_ranges = 0, disproved_ranges = 0;
  // It is given nothing, since it reports that it still renders samples that went to others.
  bool stuck = false;
  std::vector<CooldownView> cooldowns{};
};

}  // namespace tessera::scheduler
