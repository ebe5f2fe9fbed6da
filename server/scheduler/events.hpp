// SPDX-License-Identifier: Apache-2.0
// The interface between the scheduler and its caller: what happens to a farm (Event), and what the caller
// must do about it (Actions). Plain values.
#pragma once

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "core/base/error.hpp"
#include "server/scheduler/failure.hpp"
#include "server/scheduler/fingerprint.hpp"
#include "server/scheduler/interval_set.hpp"
#include "server/scheduler/job_state.hpp"
#include "server/scheduler/ledger.hpp"
#include "server/scheduler/producer.hpp"
#include "server/scheduler/types.hpp"

namespace tessera::scheduler {

// ---- Workers ----

// What a worker can do beyond the first release of the protocol.
struct Capabilities {
  // It says of which image its samples are.
  bool names_images = true;
  bool renders_layers = true;

  // Whether that is enough for a job.
  bool suffice_for(const JobShape& job) const {
    return (names_images || job.images == 1) && (renders_layers || !job.has_layers);
  }
  auto operator<=>(const Capabilities&) const = default;
};

struct WorkerInfo {
  WorkerId id;
  std::string name;
  std::string version;
  int threads = 1;
  // The machine, as proved by the worker: equal for all workers of the machine and different for all others.
  // Empty: unknown.
  std::string machine{};
  // Whom its losses and refusals count for: one caller counts once, however many workers it has. Unlike ids,
  // names and machines, a caller cannot invent it. Empty: unknown.
  std::string origin{};
  // The name of its credentials; empty without any. Individual ones belong to one machine or person: workers
  // that show them do not audit each other, and are quarantined together.
  std::string principal{};
  bool individual = false;
  // The determinism fingerprint: it is given jobs of no other. Empty: unknown, which fits every job.
  std::string determinism_fingerprint{};
  // It is given jobs for which these suffice.
  Capabilities capabilities{};
  bool operator==(const WorkerInfo&) const = default;
};

// The producer of what the worker renders.
inline Producer producer_of(const WorkerInfo& info) {
  return {info.name, info.id, info.machine, info.individual ? info.principal : std::string()};
}

// The samples that a worker reports to be rendering at this moment.
struct Rendering {
  // The worker may not hold the lease any more.
  LeaseId lease;
  JobId job;
  WorkItem item;
  bool operator==(const Rendering&) const = default;
};

// A worker reports its state and the leases that it holds. Renews its leases; answered by Actions::reply.
struct Synchronize {
  WorkerInfo worker;
  // All leases that it holds, rendered or not. Items that are no tiles of their job are ignored.
  std::vector<LeaseDescription> held{};
  // The number of leases that it wants to hold in total; at most kMaxLeasesPerWorker are given.
  int wanted_leases = 1;
  // It takes no new leases, and leases that it does not report go to others at once.
  bool draining = false;
  // Jobs whose files it fetches, or will fetch next.
  std::set<JobId> fetching{};
  // Samples outside the lease are ignored.
  std::optional<Rendering> rendering{};
};

// Retries the last, still unanswered Synchronize of a worker that Actions::wake named. It is no heartbeat: it
// renews nothing, and new leases expire with those that the worker holds already. Answered by Actions::reply.
// NOT_FOUND: the worker was forgotten.
struct TopUp {
  WorkerId worker;
};

// The worker gets no more work, and its leases go to others. NOT_FOUND: it was forgotten.
struct Dismiss {
  WorkerId worker;
  // It is also distrusted: unverified samples that were accepted from it, or from other workers of its
  // machine, must be verified.
  bool doubt = false;
};

// An administrator wants a worker to take no more leases, or to take some again. It keeps those that it has
// reported. With `stop`, its next reply says that its process must end. NOT_FOUND: it was forgotten.
struct Drain {
  WorkerId worker;
  bool drain = true;
  bool stop = false;
};

// As Dismiss::doubt, of a producer that need not be registered.
struct Distrust {
  Producer producer;
};
// The producer, its machine and its principal are trusted from now on. Its samples that must be verified
// already still must.
struct Trust {
  Producer producer;
};

// Rendered samples have arrived, at any time. Answered by Actions::verdicts. INVALID_ARGUMENT: an item is no
// tile of the job or exceeds the tile's target, or the lease was never given to this worker; nothing was
// counted. Samples beyond the target of a lease of an earlier run are dropped: that run may have extended the
// job and crashed before this was stored.
struct SubmitResult {
  WorkerId worker;
  JobId job;
  LeaseId lease;
  std::vector<WorkItem> items;
  // The time that rendering the items took. Not positive or not finite: unknown.
  double render_seconds = 0;
  // The last result of this lease: what is missing of it is free again at once.
  bool lease_finished = false;
  // Why the holder cannot build the scene and gives the lease back. Empty for any other reason.
  std::string decline_reason{};
  // The fingerprint of each item.
  std::vector<Fingerprint> fingerprints{};
  // All other leases that the worker holds and knows of. If there are any, it takes new ones with the answer
  // (Actions::reply).
  std::vector<LeaseId> held{};
  // LeaseDescription::token of the lease.
  LeaseToken token{};
  // WorkerInfo::determinism_fingerprint of its worker. The first accepted samples of a job determine that of
  // the job.
  std::string determinism_fingerprint{};
  // The caller's principal if it is individual: that of the samples if the worker is not registered.
  std::string principal{};
};

// Samples of the lease have arrived, and cannot be taken at present: the worker keeps them, with what it has
// rendered since, and delivers them again. That its leases make no progress is not its fault.
struct DeferResult {
  WorkerId worker;
  LeaseId lease;
};

inline Fingerprint fingerprint_of(const SubmitResult& result, std::size_t item) {
  return item < result.fingerprints.size() ? result.fingerprints[item] : Fingerprint{};
}

// ---- Jobs ----
// All events that name an existing job: NOT_FOUND if there is none. All that ask for a state:
// FAILED_PRECONDITION if job_state.hpp has no transition to it. They change nothing if the job is in the
// state already, so they can be repeated.

// ALREADY_EXISTS: the id is taken. INVALID_ARGUMENT: no job can have the shape (check_shape).
struct SubmitJob {
  JobId id;
  JobShape shape;
  int priority = 0;
  // The limit on workers that hold leases of it at once; 0 for none.
  std::uint32_t max_workers = 0;
};

// The producer of samples in the film that no other worker has confirmed.
struct ProducedItem {
  WorkItem item;
  Producer producer;
  Fingerprint fingerprint;
  Due due = Due::kNo;
  bool operator==(const ProducedItem&) const = default;
};

// A job as it was stored before the coordinator stopped. Jobs share the farm in the order in which they were
// submitted or restored. A running job that lacks nothing becomes done, and a done one that lacks samples
// becomes running (see Actions::job_changes). Errors: those of SubmitJob; also INVALID_ARGUMENT if `done`
// does not have the job's shape.
struct RestoreJob {
  JobId id;
  JobShape shape;
  int priority = 0;
  JobState state = JobState::kRunning;
  std::string failure;
  // The samples in the film by tile, of all images.
  std::vector<IntervalSet> done;
  std::uint32_t max_workers = 0;
  // Items that overlap, or whose samples are not done, are ignored.
  std::vector<ProducedItem> provenance{};
  FailureDetails failure_details{};
  // WorkerInfo::determinism_fingerprint of its samples. Empty: it has none.
  std::string determinism_fingerprint{};
};

// Samples of quarantined workers in the job must be verified: a done job runs again. See Actions::reopen. No
// change if there is nothing to verify. In a large job, they are found with the events that follow.
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
// A finished job leaves the scheduler, since others keep it from now on: no change of a job. RestoreJob
// brings it back. FAILED_PRECONDITION: it is running or paused, or it is still to be searched for samples of
// distrusted workers.
struct ReleaseJob {
  JobId id;
};

// Raises sample targets: those of all tiles to at least `spp`, and those of single tiles further. With tiles,
// `spp` may be 0: the others stay.
// INVALID_ARGUMENT: fewer samples per pixel than the job has, a tile that it does not have, or more than
// kMaxTileTargets such tiles.
// FAILED_PRECONDITION: it is cancelled or failed.
struct ExtendJob {
  JobId id;
  std::uint32_t spp = 0;
  std::vector<TileTarget> tiles{};
};

// Changes a job's scheduling policy; absent fields stay. FAILED_PRECONDITION: it is done, cancelled or
// failed. Ends no leases: where more workers hold some than a new limit allows, the job gets no further ones
// until fewer do.
struct UpdateJob {
  JobId id;
  std::optional<int> priority;
  std::optional<std::uint32_t> max_workers;
};

// The job cannot be rendered; `failure` is the message for its user.
struct FailJob {
  JobId id;
  std::string failure;
  FailureDetails details{};
};

// The film has lost all samples of the tile: they are missing again, and a done job runs again. Does nothing
// to a job that takes no results. See Actions::dropped_tiles.
struct DropTile {
  JobId id;
  int tile = 0;
};

// Only time has passed. Due at Scheduler::next_deadline().
struct Tick {};

using Event = std::variant<Synchronize, TopUp, Dismiss, Drain, Distrust, Trust, SubmitResult, SubmitJob,
                           RestoreJob, PauseJob, ReopenJob, ResumeJob, CancelJob, DeleteJob, ExtendJob,
                           UpdateJob, FailJob, DropTile, Tick, ReleaseJob, DeferResult>;

// ---- Answers ----

// What a worker should be doing.
struct Reply {
  // All leases that it should hold, oldest first. Items are the missing samples of a lease, without those
  // that others have delivered meanwhile.
  std::vector<LeaseDescription> leases;
  // Whether these leases differ from those that the worker has reported or was told of, or have lost items to
  // others since its last reply. If not, the answer can wait until Actions::wake names the worker.
  bool changed = false;
  // The worker's leases go to others unless it synchronises within this time.
  Duration heartbeat_timeout{};
  // The worker's process must end (Drain).
  bool stop = false;
};

enum class Verdict {
  kAccepted,  // it was missing and now counts as done: the caller must add it to the film, in the order of
              // events
  kAudited,   // it verifies samples in the film, and must not be added
  kDropped,   // some of its samples are in the film or outside the job, or the job takes no more results
};

struct JobChange {
  JobId id;
  JobState from = JobState::kRunning, to = JobState::kRunning;
  bool operator==(const JobChange&) const = default;
};

// A worker's sums differ from those on which two others agree.
struct Disproof {
  Producer producer;
  // The details, for people.
  std::string because;
};

struct TileOfJob {
  JobId job;
  int tile = 0;
  bool operator==(const TileOfJob&) const = default;
};

// A job is done without some audits that were chosen by lot, since no worker could do them.
struct Unaudited {
  JobId job;
  std::size_t ranges = 0;
};

// A job that lacks nothing but samples to verify, and has done so for Options::unattended_patience.
struct Unattended {
  JobId job;
  std::uint64_t samples = 0;
};

struct Actions {
  // Why the event was refused. A refused event has changed nothing; but the passing of time may have, so the
  // other actions must be done all the same.
  core::Status status;
  // The answer to Synchronize and TopUp. For a SubmitResult, present if new leases are told with its answer
  // while the worker's Synchronize still waits: `changed` if there are others than SubmitResult::held.
  std::optional<Reply> reply;
  // One for each item of a SubmitResult.
  std::vector<Verdict> verdicts;
  // All changes of state in order, including indirect ones: RUNNING to DONE with a result, or RUNNING to
  // FAILED with the third machine that a range cost (its worker died of the range, or was stuck in it).
  std::vector<JobChange> job_changes;
  // Workers to quarantine. Their leases have ended already.
  std::vector<Disproof> disproved;
  // Workers that are distrusted from now on: jobs that the scheduler does not have may have samples of them.
  std::vector<Producer> distrusted;
  // All samples of these tiles are missing again: clear them before the accepted items are added.
  std::vector<TileOfJob> dropped_tiles;
  // Scheduler::provenance() has changed for these tiles, besides those of accepted items.
  std::vector<TileOfJob> reviewed_tiles;
  // Done jobs with unverified samples of quarantined workers: hand in ReopenJob when their films are in
  // memory again.
  std::vector<JobId> reopen;
  // Ranges for which two workers rendered different sums and a third must decide; for the log.
  std::vector<std::string> contradictions;
  std::vector<Unaudited> unaudited;
  // Each once, until somebody verifies samples of the job; for the log. Not due at a time: reported with the
  // next event.
  std::vector<Unattended> unattended;
  // Workers that send heartbeats, but have delivered nothing of a job for too long, so that their leases of
  // it went to others; for the log.
  std::vector<std::string> stalled;
  // Workers whose last reply was not `changed` and could be now. If the call of one still waits, hand in
  // TopUp, and answer the call if the reply is `changed`. Ignore the others. If many wait, the first few are
  // named, and others with the next events.
  std::vector<WorkerId> wake;
  // Jobs and workers whose views have changed, besides counters of progress and what only the time changes;
  // each once, in the order of their first change. Jobs: submitted, restored or deleted, or another shape,
  // policy, state or failure. Workers: registered or forgotten, lost or back, draining or not, stuck or not,
  // described differently, or a cooldown that begins or ends before its time.
  std::vector<JobId> changed_jobs;
  std::vector<WorkerId> changed_workers;
  // Jobs of which other samples are done or to verify, or another number of workers holds leases; and
  // workers that hold other leases, or of which samples were accepted or verified others. Each once. The
  // leases of a job that has ended are taken from their holders with later events.
  std::vector<JobId> progressed_jobs;
  std::vector<WorkerId> progressed_workers;
  // State that nobody needs any more. To destroy it may take tens of milliseconds: let go of it where nobody
  // waits for that, such as after releasing a lock.
  std::vector<std::shared_ptr<const void>> discarded;
};

}  // namespace tessera::scheduler
