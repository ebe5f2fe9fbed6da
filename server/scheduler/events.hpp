// SPDX-License-Identifier: Apache-2.0
// What happens to a farm (Event), and what is to be done about it (Actions): the whole interface between the
// scheduler and the outside. Plain values.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "core/base/error.hpp"
#include "server/scheduler/fingerprint.hpp"
#include "server/scheduler/interval_set.hpp"
#include "server/scheduler/job_state.hpp"
#include "server/scheduler/ledger.hpp"
#include "server/scheduler/producer.hpp"
#include "server/scheduler/types.hpp"

namespace tessera::scheduler {

// ---- Workers ----

struct WorkerInfo {
  WorkerId id;
  std::string name;
  std::string version;
  int threads = 1;
  // Which machine it runs on, as it has proved; the same for every worker of that machine, and for no other.
  // Empty: unknown.
  std::string machine{};
  // Who answers for it, as the coordinator knows the caller; a caller can make up ids, names and machines,
  // but not this. Empty: unknown.
  std::string principal{};
};

// What a worker says that it renders at this moment.
struct Rendering {
  // Its own or not any more.
  LeaseId lease;
  JobId job;
  WorkItem item;
  bool operator==(const Rendering&) const = default;
};

// A worker says what it is and what it holds. Renews its leases; answered by Actions::reply.
struct Synchronize {
  WorkerInfo worker;
  // Everything it holds, rendered or not. Items that are no tiles of their job are overlooked.
  std::vector<LeaseDescription> held;
  // How many leases it would like to hold in all; more than kMaxLeasesPerWorker are not given.
  int wanted_leases = 1;
  // It takes no new leases, and what it does not hold any more goes to others at once.
  bool draining = false;
  // Jobs whose files it is fetching, or is about to.
  std::set<JobId> fetching{};
  // Samples that are not among those of the lease are overlooked.
  std::optional<Rendering> rendering{};
};

// Asks again on behalf of a worker whose last Synchronize is still unanswered, since Actions::wake named it.
// Not a sign of life: renews nothing, and what is granted runs out with what the worker holds already.
// Answered by Actions::reply. NOT_FOUND: the worker has been forgotten.
struct TopUp {
  WorkerId worker;
};

// The worker is to have no more work: what it holds goes to others. NOT_FOUND: it has been forgotten.
struct Dismiss {
  WorkerId worker;
  // It is not to be trusted either: what was counted of it, or of any other of its machine, is to be
  // verified, unless it was.
  bool doubt = false;
};

// Rendered samples have arrived, however late. Answered by Actions::verdicts. INVALID_ARGUMENT: an item is no
// tile of the job or leaves samples [0, spp), or the lease was never given to this worker; nothing was
// counted. Samples beyond spp of a lease of an earlier run are dropped: that run may have
// extended the job, and crashed before this was stored.
struct SubmitResult {
  WorkerId worker;
  JobId job;
  LeaseId lease;
  std::vector<WorkItem> items;
  // Time it took to render the items. Not positive or not finite: unknown.
  double render_seconds = 0;
  // No more will come for this lease: what is missing of it is free again at once.
  bool lease_finished = false;
  // Why the holder of the lease gives it back: it cannot build the scene. Empty for any other reason.
  std::string decline_reason{};
  // Of each item.
  std::vector<Fingerprint> fingerprints{};
  // All other leases that the worker holds and has heard of. If there are some, it takes new ones with the
  // answer (Actions::reply).
  std::vector<LeaseId> held{};
  // LeaseDescription::token of the lease.
  LeaseToken token{};
};

inline Fingerprint fingerprint_of(const SubmitResult& result, std::size_t item) {
  return item < result.fingerprints.size() ? result.fingerprints[item] : Fingerprint{};
}

// ---- Jobs ----
// All that name an existing job: NOT_FOUND if there is none. All that ask for a state: FAILED_PRECONDITION if
// no arrow of job_state.hpp leads there, and no change if the job is in it already, so that they can be
// repeated.

// ALREADY_EXISTS: the id is taken. INVALID_ARGUMENT: a picture or a sample count of nothing.
struct SubmitJob {
  JobId id;
  JobShape shape;
  int priority = 0;
  // Most workers that hold leases of it at once; 0 for as many as there are.
  std::uint32_t max_workers = 0;
};

// Who rendered samples that are in the film, where nobody else has confirmed them.
struct ProducedItem {
  WorkItem item;
  Producer producer;
  Fingerprint fingerprint;
  Due due = Due::kNo;
  bool operator==(const ProducedItem&) const = default;
};

// A job as it was stored before the coordinator stopped. Jobs share the farm in the order in which they were
// submitted or restored. A running job that lacks nothing becomes done and a done one that lacks samples runs
// (see Actions::job_changes). Errors: those of SubmitJob; also INVALID_ARGUMENT if `done` is not of the job's
// shape.
struct RestoreJob {
  JobId id;
  JobShape shape;
  int priority = 0;
  JobState state = JobState::kRunning;
  std::string failure;
  // For each tile, the samples that are in the film.
  std::vector<IntervalSet> done;
  std::uint32_t max_workers = 0;
  // Items that are not among the samples done, or overlap, are overlooked.
  std::vector<ProducedItem> provenance{};
};

// What workers that were quarantined have rendered of the job is to be verified: if it is done, it runs
// again. See Actions::reopen. No change if there is nothing to verify.
struct ReopenJob {
  JobId id;
};

struct PauseJob {
  JobId id;
};
struct ResumeJob {
  JobId id;
};
struct CancelJob {
  JobId id;
};
struct DeleteJob {
  JobId id;
};

// Raises a job's samples per pixel. INVALID_ARGUMENT: fewer than it has. FAILED_PRECONDITION: it is cancelled
// or failed.
struct ExtendJob {
  JobId id;
  std::uint32_t spp = 0;
};

// Changes how a job is served; what is absent stays. FAILED_PRECONDITION: it is done, cancelled or failed.
// Takes no lease away: where more workers hold some than a new limit allows, the job is given no further ones
// until fewer do.
struct UpdateJob {
  JobId id;
  std::optional<int> priority;
  std::optional<std::uint32_t> max_workers;
};

// It cannot be rendered; `failure` is the sentence for its user.
struct FailJob {
  JobId id;
  std::string failure;
};

// Nothing but the passing of time. Due at Scheduler::next_deadline().
struct Tick {};

using Event = std::variant<Synchronize, TopUp, Dismiss, SubmitResult, SubmitJob, RestoreJob, PauseJob,
                           ReopenJob, ResumeJob, CancelJob, DeleteJob, ExtendJob, UpdateJob, FailJob, Tick>;

// ---- Answers ----

// What a worker should be doing.
struct Reply {
  // Everything it should hold, oldest first. Items are what is still missing of the lease: those that others
  // have delivered meanwhile are gone from it.
  std::vector<LeaseDescription> leases;
  // Whether these are other leases than the worker has reported or was told of, or have lost items to others
  // since its last reply. If not, there is no hurry to answer: the call can wait until Actions::wake names
  // the worker.
  bool changed = false;
  // Unless the worker is heard of again within this time, its leases go to others.
  Duration heartbeat_timeout{};
};

enum class Verdict {
  kAccepted,  // was missing, and is now counted as done: the caller must add it to the film before the next
              // event
  kAudited,   // was rendered to verify what is in the film, where it must not be added again
  kDropped,   // at least one of its samples is in the film already or is no more of the job, or the job takes
              // no results any more
};

struct JobChange {
  JobId id;
  JobState from = JobState::kRunning, to = JobState::kRunning;
  bool operator==(const JobChange&) const = default;
};

// A worker has rendered other bits than two others.
struct Disproof {
  Producer producer;
  // What it was, for people.
  std::string because;
};

struct TileOfJob {
  JobId job;
  int tile = 0;
  bool operator==(const TileOfJob&) const = default;
};

// A job is done, and ranges of it that were chosen for an audit had none: there was nobody for it.
struct Unaudited {
  JobId job;
  std::size_t ranges = 0;
};

struct Actions {
  // Why the event was refused. A refused event has changed nothing; the time that has passed may have, and
  // the rest of the actions is to be done all the same.
  core::Status status;
  // For Synchronize and TopUp. For a SubmitResult if it is to be told with its answer, while the worker's
  // Synchronize waits on: `changed` if there are others than SubmitResult::held.
  std::optional<Reply> reply;
  // For SubmitResult: one for each item.
  std::vector<Verdict> verdicts;
  // Every change of state, in order; also those that follow from something else (RUNNING to DONE with a
  // result, RUNNING to FAILED with the third machine whose worker died of one range or was stuck in it).
  std::vector<JobChange> job_changes;
  // These workers are to be quarantined. Their leases are gone already.
  std::vector<Disproof> disproved;
  // Everything in these tiles is missing again: empty them before the accepted items are added.
  std::vector<TileOfJob> dropped_tiles;
  // Scheduler::authored() has changed for these tiles, apart from those of accepted items.
  std::vector<TileOfJob> reviewed_tiles;
  // Done jobs with samples of workers that were quarantined: hand in ReopenJob as soon as their films are at
  // hand again.
  std::vector<JobId> reopen;
  // Two workers have rendered other bits of this, and a third must decide; for the log.
  std::vector<std::string> contradictions;
  std::vector<Unaudited> unaudited;
  // Workers that are heard of, but from which nothing has come of a job for long, so that others have what
  // they held of it; for the log.
  std::vector<std::string> stalled;
  // Workers whose last reply was not `changed` and could now be. For each whose call is still waiting, hand
  // in TopUp, and answer the call if the reply is `changed`. For others do nothing.
  std::vector<WorkerId> wake;
};

}  // namespace tessera::scheduler
