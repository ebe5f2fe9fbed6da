// SPDX-License-Identifier: Apache-2.0
// The samples of one job: which are done, leased or free; and its progress. Knows worker ids, but nothing
// else of workers, of other jobs, or of deadlines. Not thread-safe.
//
// A sample is done or missing. A missing sample is leased (to one worker, or to two near the end) or free. A
// done sample may need verification: another worker renders it again under a lease of its own kind, an audit.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "server/scheduler/audits.hpp"
#include "server/scheduler/failure.hpp"
#include "server/scheduler/interval_set.hpp"
#include "server/scheduler/job_state.hpp"
#include "server/scheduler/lease_table.hpp"
#include "server/scheduler/poison_tracker.hpp"
#include "server/scheduler/policy.hpp"
#include "server/scheduler/rate_meter.hpp"
#include "server/scheduler/tile_costs.hpp"
#include "server/scheduler/tile_table.hpp"
#include "server/scheduler/types.hpp"
#include "server/scheduler/work_list.hpp"

namespace tessera::scheduler {

// Candidates for the next lease.
struct Portion {
  std::vector<WorkItem> items;
  // The worker may hold nothing else meanwhile (poison_tracker.hpp).
  bool alone = false;
  // The samples are done (Lease::auditor).
  bool audit = false;
};

// A worker that cannot build the scene; fields as in Loss.
struct Refuser {
  WorkerId worker;
  std::string name;
  std::string principal{};
};

// Whether every worker that could render the job, and would report it if it could not, is one of these: by
// WorkerInfo::origin or by name. Losses and refusals fail a job only if three principals have them, or
// all if there are fewer: one caller can register any number of workers.
using AreAll = std::function<bool(const std::set<std::string>&)>;

// How a job is served.
struct SchedulingPolicy {
  int priority = 0;
  // The limit on workers that hold leases of it at once; 0 for none.
  std::uint32_t max_workers = 0;
  bool operator==(const SchedulingPolicy&) const = default;
};

// What results and leases change of a job, in pixel samples and workers.
struct Progress {
  std::uint64_t done = 0, to_verify = 0;
  std::size_t holders = 0;
  bool operator==(const Progress&) const = default;
};

// What is left of a run that has ended. May take long to destroy.
struct EndedRun {
  RunNumber number = 0;
  LeaseTable leases{}, audit_leases{};
  std::map<WorkerId, int> lease_counts{};
  std::set<LeaseId> copyable{};
  std::set<WorkerId> stalled_workers{};
  // The workers that could not build the scene.
  std::set<WorkerId> refusers{};
};

class Job {
 public:
  // A new or a stored job. `done`: the samples that are done, by tile; empty: none. Takes no time that
  // depends on the size of a new job, but for tiles with targets of their own.
  Job(JobNumber number, JobId id, JobShape shape, SchedulingPolicy policy, JobState state,
      const std::vector<IntervalSet>& done);

  JobNumber number() const { return number_; }
  const JobId& id() const { return id_; }
  const JobShape& shape() const { return shape_; }
  const SchedulingPolicy& policy() const { return policy_; }
  // Ends no leases.
  void set_policy(const SchedulingPolicy& policy);
  JobState state() const { return state_; }
  // The only function that changes the state. The transition must be valid (job_state.hpp).
  void become(JobState to);
  RunNumber run() const { return run_; }
  // Ends the run, with all leases, and begins another. The caller revokes what is returned. The job must be
  // about to end, or lack nothing.
  EndedRun begin_run(RunNumber next);

  // Why the job failed; empty unless it has.
  std::string failure;
  FailureDetails failure_details;
  // The progress that was last reported (Actions::progressed_jobs).
  Progress reported;

  // WorkerInfo::determinism_fingerprint of its samples; empty before the first. Does not change after that.
  const std::string& determinism_fingerprint() const { return determinism_fingerprint_; }
  void set_determinism_fingerprint(const std::string& fingerprint) {
    if (determinism_fingerprint_.empty()) determinism_fingerprint_ = fingerprint;
  }

  // ---- Counts of pixel samples ----
  std::uint64_t total() const { return total_; }
  std::uint64_t done() const { return done_count_; }
  std::uint64_t leased() const { return leased_count_; }
  std::uint64_t free() const { return total_ - done_count_ - leased_count_; }
  bool complete() const { return done_count_ == total_; }
  std::uint64_t to_verify() const { return audits_.due(); }
  Progress progress() const { return {done(), to_verify(), holder_count()}; }
  // Complete, with nothing left to verify.
  bool settled() const { return complete() && to_verify() == 0; }
  std::uint64_t pixel_samples(const WorkItem& item) const;
  // The same in pixel samples of the mean cost.
  double mean_samples(const WorkItem& item) const;

  const IntervalSet& done(int tile) const { return done_[tile]; }
  // The leases of missing samples.
  const LeaseTable& leases() const { return leases_; }
  // The leases of audits.
  const LeaseTable& audit_leases() const { return audit_leases_; }
  // A lease of either kind; null if there is none.
  const Lease* find_lease(LeaseId id) const;
  std::size_t lease_count() const { return leases_.all().size() + audit_leases_.all().size(); }
  // The workers that hold leases of either kind.
  std::size_t holder_count() const { return lease_counts_.size(); }
  bool is_holder(const WorkerId& worker) const { return lease_counts_.contains(worker); }
  // Whether the limit on workers allows a lease for this worker, and for one that holds none.
  bool may_be_leased_to(const WorkerId& worker) const;
  bool may_have_another_holder() const;
  // The pixel samples in audit leases.
  std::uint64_t auditing() const { return auditing_count_; }

  // ---- Candidates for leases. These functions change nothing, and return at most kMaxItemsPerLease items
  // for lease() ----

  // The next free items, of this size or slightly more. Empty only if nothing is free, or if the next items
  // must be leased alone and the worker holds something.
  Portion next_free(LeaseSize size, bool holds_nothing) const;
  // Items that exactly one worker holds, and not alone, of the oldest leases first. For workers that hold
  // nothing.
  Portion next_copies(LeaseSize size) const;
  // next_copies() was empty: it is not searched again until a lease changes.
  void note_no_copies() { copyable_.clear(); }
  // Whether there may be copies, of leases of either kind.
  bool may_have_copies() const { return !copyable_.empty() || audits_.any_shareable(); }
  // Audits for this worker; as a copy, those that one other worker has in progress.
  Portion next_audits(LeaseSize size, bool holds_nothing, const Producer& worker,
                      const Producers& producers) const;
  Portion next_audit_copy(const Producer& worker, const Producers& producers) const;
  // The free samples of these items. Ignores items that are no part of the job.
  std::vector<WorkItem> free_parts(const std::vector<WorkItem>& items) const;

  void lease(Lease lease);

  // The lease's holder has reported it. It must exist.
  void acknowledge(LeaseId id);
  // Ends a lease, which must exist, in a final state. Samples that no other lease has become free.
  Lease end_lease(LeaseId id, LeaseState to);

  // ---- Results ----

  // Whether the job has the tile, and whether these are samples that it is to get.
  bool has_tile(int tile) const { return tile >= 0 && tile < grid_.tile_count(); }
  bool has(const WorkItem& item) const;
  // Counts the item as done if all of it is missing. Returns whether it was. Leases that have nothing left to
  // do are ended and appended to `ended`.
  bool accept(const WorkItem& item, std::vector<Lease>& ended);
  // Records the producer of an item that was just accepted, and its sums.
  void note_producer(const WorkItem& item, ProducerNumber producer, const Fingerprint& fingerprint, Due due) {
    audits_.add(item, producer, fingerprint, due);
  }

  // ---- Audits ----

  const Audits& audits() const { return audits_; }
  // Whether the lease's holder was asked to audit these samples.
  bool is_audit(LeaseId lease, const WorkItem& item) const;
  // Takes the sums of audited samples. Leases that have nothing left to do are ended and appended to `ended`.
  std::optional<Ruling> audit(LeaseId lease, const WorkItem& item, const Fingerprint& fingerprint,
                              std::vector<Lease>& ended);
  // Marks all samples of the tile as missing.
  void drop_tile(int tile, std::vector<Lease>& ended);
  bool doubt(int tile, const Producers& producers) { return audits_.doubt(tile, producers); }
  // Cancels audits that were chosen by lot, at most so many, and returns how many of the job it has
  // cancelled.
  std::size_t waive_audits(std::size_t most) { return waived_ += audits_.waive(most); }
  // Forgets the producers. Returns what was known of them, which may take long to destroy.
  Audits take_audits();

  // ---- Losses and refusals ----

  // Counts the death of an ended lease's holder. Returns the failure of the job, if this is one
  // death too many and nobody else holds the samples.
  std::optional<Failure> strike(const Lease& lease, const Loss& loss, const AreAll& principals);
  // The same for a worker that is stuck in these samples, as far as they are missing.
  std::optional<Failure> strike(const std::vector<WorkItem>& items, const Loss& loss,
                                const AreAll& principals);
  // The failure of the job, if no sample of it was ever accepted, nobody holds any of it, and
  // workers of three names were stuck in different ranges of it.
  std::optional<Failure> nobody_gets_on(const AreAll& principals) const;
  // Counts a worker that cannot build the scene. Returns the failure of the job, if this
  // happened three times in a row, with workers of three names, or of all names and every worker that holds a
  // lease.
  std::optional<Failure> decline_reason(const Refuser& refuser, const std::string& why, const AreAll& names,
                                        const AreAll& principals);
  // The worker was not lost: one that was presumed dead is alive, or one that was stuck goes on.
  void withdraw_strikes(const WorkerId& worker, LossKind kind);
  // Whether there may be strikes for a loss of this worker.
  bool may_have_strikes_of(const WorkerId& worker) const { return poison_.may_name(worker); }
  // Contains every worker whose leases of it have stalled in this run, and that has delivered nothing since;
  // may contain others.
  const std::set<WorkerId>& stalled_workers() const { return stalled_workers_; }
  void note_stalled(const WorkerId& worker) { stalled_workers_.insert(worker); }
  void note_progress(const WorkerId& worker) { stalled_workers_.erase(worker); }
  void note_refuser(const WorkerId& worker) { refusers_of_run_.insert(worker); }

  // Raises targets (JobShape::raise). The tiles must be of the job.
  void extend(std::uint32_t spp, const std::vector<TileTarget>& tiles);

  // ---- Progress ----
  // The work of one of its pixel samples, in the unit of Worker::pace.
  Estimate cost;
  // Takes the time of a result, in the mean samples (above) that its worker renders in that time by what was
  // known of it. The items must be of the job.
  void learn_costs(const std::vector<WorkItem>& items, double mean_samples);
  RateMeter rate;
  // See JobSnapshot. virtual_finish is the end of its latest lease in virtual time.
  std::uint64_t last_served = 0;
  double virtual_finish = 0;

  // Whether a lease has samples that a second worker could be given. Slow; for invariant checks.
  bool has_copies_to_give() const;
  // The invariants of its counters, of one lease, and of every sample.
  std::optional<std::string> check() const;
  std::optional<std::string> check_lease(const Lease& lease) const;
  std::optional<std::string> check_samples() const;

 private:
  IntervalSet free_of(const WorkItem& item) const;
  std::vector<WorkItem> held_once(const Lease& lease) const;
  bool has_copies(const Lease& lease) const;
  void forget_what_is_leased();
  void append_copies(const std::vector<WorkItem>& pieces, LeaseSize& left, Portion& portion) const;
  std::uint32_t samples_for(int tile, const LeaseSize& left) const;
  void take_from(LeaseSize& left, const WorkItem& item) const;
  bool is_suspect(const WorkItem& item) const;
  void lease_audit(Lease lease);
  Lease end_audit(LeaseId id, LeaseState to);
  void trim_audits(const WorkItem& item, std::vector<Lease>& ended);
  std::optional<Failure> verdict_on(const WorkItem& item, const AreAll& principals) const;
  std::optional<std::string> check_tile(int tile) const;
  std::size_t workers_beyond_limit() const;
  void note_ended_lease(const Lease& lease);
  std::optional<std::string> check_audits() const;

  const JobNumber number_;
  JobId id_;
  JobShape shape_;
  JobGrid grid_;
  SchedulingPolicy policy_;
  // Workers beyond a lowered limit that still hold leases.
  std::size_t tolerated_workers_ = 0;
  JobState state_;
  std::string determinism_fingerprint_;
  RunNumber run_ = 0;

  TileTable<IntervalSet> done_;
  WorkList work_;
  TileCosts costs_;
  LeaseTable leases_, audit_leases_;
  // Leases of either kind by holder, without zeros.
  std::map<WorkerId, int> lease_counts_;
  Audits audits_;
  PoisonTracker poison_;
  // Workers with different names that were stuck in any samples; cleared with the first accepted sample.
  std::vector<Loss> stuck_before_any_;
  // Consecutive refusals and the names of their workers; cleared with every accepted sample.
  int refusals_ = 0;
  std::set<std::string> refusers_;
  std::set<std::string> refusing_principals_;
  std::set<WorkerId> refusing_workers_;
  // Of this run.
  std::set<WorkerId> stalled_workers_, refusers_of_run_;
  std::size_t waived_ = 0;
  // Contains every lease with samples that nobody else holds; may contain others.
  std::set<LeaseId> copyable_;

  std::uint64_t total_ = 0;
  std::uint64_t done_count_ = 0;
  // Samples with two holders count once.
  std::uint64_t leased_count_ = 0;
  // Samples with two auditors count twice.
  std::uint64_t auditing_count_ = 0;
};

}  // namespace tessera::scheduler
