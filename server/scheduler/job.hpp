// SPDX-License-Identifier: Apache-2.0
// One job's samples: which are done, which are leased to whom, which are free; and how it is doing. Knows
// nothing of other jobs, of workers beyond their ids, or of time running out. Not thread-safe.
//
// A sample is done, or missing. A missing one is leased (to one worker, or to two near the end) or free. A
// done one may have to be verified: rendered again by another worker, under a lease of its own kind, an
// audit.
#pragma once

#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "server/scheduler/audits.hpp"
#include "server/scheduler/interval_set.hpp"
#include "server/scheduler/job_state.hpp"
#include "server/scheduler/lease_table.hpp"
#include "server/scheduler/poison_tracker.hpp"
#include "server/scheduler/policy.hpp"
#include "server/scheduler/rate_meter.hpp"
#include "server/scheduler/types.hpp"
#include "server/scheduler/work_list.hpp"

namespace tessera::scheduler {

// What might be leased next.
struct Portion {
  std::vector<WorkItem> items;
  // To a worker that holds nothing else, and is given nothing else until it is done.
  bool alone = false;
  // Of samples that are done (Lease::auditor).
  bool audit = false;
};

// Who says that it cannot build the scene; as in Loss.
struct Refuser {
  WorkerId worker;
  std::string name;
  std::string principal{};
};

// WorkerInfo::principal of the workers that can render. Losses and refusals fail a job only by the word of
// three principals, or of all if there are fewer: one caller can make up any number of workers.
using Principals = std::set<std::string>;
using FindPrincipals = std::function<Principals()>;

// How a job is served.
struct SchedulingPolicy {
  int priority = 0;
  // Most workers that hold leases of it at once; 0 for as many as there are.
  std::uint32_t max_workers = 0;
};

class Job {
 public:
  // As it is submitted, or was stored. `done`: for each tile, the samples that are done; empty: none.
  Job(JobId id, JobShape shape, SchedulingPolicy policy, JobState state, std::vector<IntervalSet> done);

  const JobId& id() const { return id_; }
  const JobShape& shape() const { return shape_; }
  const SchedulingPolicy& policy() const { return policy_; }
  // Takes no lease away.
  void set_policy(const SchedulingPolicy& policy);
  JobState state() const { return state_; }
  // The one way in which its state changes. The arrow must be drawn (job_state.hpp).
  void become(JobState to);

  // Why it failed; empty unless it has.
  std::string failure;

  // ---- Counts of pixel samples ----
  std::uint64_t total() const { return total_; }
  std::uint64_t done() const { return done_count_; }
  std::uint64_t leased() const { return leased_count_; }
  std::uint64_t free() const { return total_ - done_count_ - leased_count_; }
  bool complete() const { return done_count_ == total_; }
  std::uint64_t to_verify() const { return audits_.due(); }
  // Complete, and nothing is left to verify.
  bool settled() const { return complete() && to_verify() == 0; }
  std::uint64_t pixel_samples(const WorkItem& item) const;

  const IntervalSet& done(int tile) const { return done_[static_cast<std::size_t>(tile)]; }
  // Of missing samples.
  const LeaseTable& leases() const { return leases_; }
  // Of samples that are rendered again.
  const LeaseTable& audit_leases() const { return audit_leases_; }
  // Of either kind; null if there is none.
  const Lease* find_lease(LeaseId id) const;
  std::size_t lease_count() const { return leases_.all().size() + audit_leases_.all().size(); }
  // Workers that hold leases of either kind.
  std::size_t holder_count() const;
  bool is_holder(const WorkerId& worker) const {
    return leases_.is_holder(worker) || audit_leases_.is_holder(worker);
  }
  // Whether the worker can be given a lease, as far as the limit on workers goes.
  bool may_be_leased_to(const WorkerId& worker) const;
  // Pixel samples that are rendered again.
  std::uint64_t auditing() const { return auditing_count_; }

  // ---- Choosing what to lease: follows from the job as it is, and changes nothing of it. Of at most
  // kMaxItemsPerLease items, for lease() ----

  // The next free items, of `samples` pixel samples or a little more. Empty only if nothing is free, or if
  // what comes next must be leased alone and the worker holds something.
  Portion next_free(std::uint64_t samples, bool holds_nothing) const;
  // Items that exactly one worker holds, and not alone; of the oldest leases first. For workers that hold
  // nothing.
  Portion next_copies(std::uint64_t samples) const;
  // It was empty: not looked for again until one of the leases changes.
  void note_no_copies() { copyable_.clear(); }
  // What is due for an audit by this worker; as a copy, of what one other is at.
  Portion next_audits(std::uint64_t samples, bool holds_nothing, const Producer& worker,
                      const Producers& producers) const;
  Portion next_audit_copy(const Producer& worker, const Producers& producers) const;
  // What is free of these items. Overlooks what is no part of the job.
  std::vector<WorkItem> free_parts(const std::vector<WorkItem>& items) const;

  void lease(Lease lease);

  // Its holder has reported it. It must exist.
  void acknowledge(LeaseId id);
  // Ends a lease, which must exist, in a state that is final. What nobody else holds of it is free.
  Lease end_lease(LeaseId id, LeaseState to);
  // Revokes them.
  std::vector<Lease> end_all_leases();

  // ---- Results ----

  // Whether these are samples of the job at all.
  bool has(const WorkItem& item) const;
  // Counts the item as done if all of it is missing. Returns whether it was. Leases that have nothing left to
  // do are ended and appended to `ended`.
  bool accept(const WorkItem& item, std::vector<Lease>& ended);
  // Who rendered an item that was just accepted, and its sums.
  void note_producer(const WorkItem& item, ProducerNumber producer, const Fingerprint& fingerprint, Due due) {
    audits_.add(item, producer, fingerprint, due);
  }

  // ---- Audits ----

  const Audits& audits() const { return audits_; }
  // Whether these are samples that the lease's holder was asked to render again.
  bool is_audit(LeaseId lease, const WorkItem& item) const;
  // Takes the sums of such samples. Leases that have nothing left to do are ended and appended to `ended`.
  std::optional<Ruling> audit(LeaseId lease, const WorkItem& item, const Fingerprint& fingerprint,
                              std::vector<Lease>& ended);
  // All samples of the tile are missing again.
  void drop_tile(int tile, std::vector<Lease>& ended);
  std::vector<int> doubt(const Producers& producers) { return audits_.doubt(producers); }
  std::size_t waive_audits() { return audits_.waive(); }
  void forget_producers() { audits_.clear(); }
  // Since when it has been waiting for nothing but audits for which there is nobody.
  std::optional<Time> unaudited_since;

  // ---- Losses and refusals ----

  // The holder of an ended lease has died. The sentence to fail the job with, if this is enough and nobody
  // else holds the samples.
  std::optional<std::string> strike(const Lease& lease, const Loss& loss, const FindPrincipals& present);
  // The same of a worker that is stuck in these samples, as far as they are missing.
  std::optional<std::string> strike(const std::vector<WorkItem>& items, const Loss& loss,
                                    const FindPrincipals& present);
  // The sentence to fail the job with, if nothing of it was ever counted, nobody holds any of it, and workers
  // of three names were stuck in whatever they had of it.
  std::optional<std::string> nobody_gets_on(const FindPrincipals& present) const;
  // A worker cannot build the scene. The sentence to fail the job with, if that was said three times in a
  // row, and by workers of three names, or by all names that are `present` and every worker that holds a
  // lease.
  std::optional<std::string> decline_reason(const Refuser& refuser, const std::string& why,
                                            const std::set<std::string>& present,
                                            const FindPrincipals& principals);
  // A worker that was taken for dead lives, or for stuck goes on to something else.
  void withdraw_strikes(const WorkerId& worker, LossKind kind);

  void extend(std::uint32_t spp);

  // ---- How it is doing ----
  // What a pixel sample of it costs in work, as Worker::pace counts it.
  Estimate cost;
  RateMeter rate;
  // Of JobSnapshot; the end of its latest lease in virtual time.
  std::uint64_t last_served = 0;
  double virtual_finish = 0;

  // Whether a lease has samples that a second worker could be given. Slow; for checks.
  bool has_copies_to_give() const;
  // See CheckDepth.
  std::optional<std::string> check(bool every_sample) const;

 private:
  IntervalSet free_of(const WorkItem& item) const;
  std::vector<WorkItem> held_once(const Lease& lease) const;
  bool has_copies(const Lease& lease) const;
  void forget_what_is_leased();
  void append_copies(const std::vector<WorkItem>& pieces, std::uint64_t& budget, Portion& portion) const;
  std::uint32_t samples_for(int tile, std::uint64_t budget) const;
  bool is_suspect(const WorkItem& item) const;
  void lease_audit(Lease lease);
  Lease end_audit(LeaseId id, LeaseState to);
  void trim_audits(const WorkItem& item, std::vector<Lease>& ended);
  std::optional<std::string> verdict_on(const WorkItem& item, const FindPrincipals& present) const;
  std::optional<std::string> check_tile(int tile) const;
  std::optional<std::string> check_counts() const;
  std::size_t workers_beyond_limit() const;
  void note_ended_lease();
  std::optional<std::string> check_leases() const;
  std::optional<std::string> check_audits() const;

  JobId id_;
  JobShape shape_;
  core::TileGrid grid_;
  SchedulingPolicy policy_;
  // Workers beyond the limit that held leases when it was lowered, and still do.
  std::size_t tolerated_workers_ = 0;
  JobState state_;

  std::vector<IntervalSet> done_;
  WorkList work_;
  LeaseTable leases_, audit_leases_;
  Audits audits_;
  PoisonTracker poison_;
  // Workers that were stuck in any samples, of different names; forgotten with the first accepted sample.
  std::vector<Loss> stuck_before_any_;
  // In a row, and who said so; forgotten with every accepted sample.
  int refusals_ = 0;
  std::set<std::string> refusers_;
  Principals refusing_principals_;
  std::set<WorkerId> refusing_workers_;
  // Every lease with samples that nobody else holds; may also have others.
  std::set<LeaseId> copyable_;

  std::uint64_t total_ = 0;
  std::uint64_t done_count_ = 0;
  // Samples with two holders count once.
  std::uint64_t leased_count_ = 0;
  // Samples with two auditors count twice.
  std::uint64_t auditing_count_ = 0;
};

}  // namespace tessera::scheduler
