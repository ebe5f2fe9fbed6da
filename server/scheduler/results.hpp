// SPDX-License-Identifier: Apache-2.0
// Results of workers are checked and counted. Part of the scheduler.
#pragma once

#include <cstdint>

#include "server/scheduler/auditing.hpp"
#include "server/scheduler/farm_state.hpp"
#include "server/scheduler/jobs.hpp"
#include "server/scheduler/leases.hpp"
#include "server/scheduler/losses.hpp"
#include "server/scheduler/quorum.hpp"

namespace tessera::scheduler {

class Results {
 public:
  Results(FarmState& farm, Leases& leases, Jobs& jobs, Losses& losses, Auditing& auditing)
      : farm_(farm), leases_(leases), jobs_(jobs), losses_(losses), auditing_(auditing), quorum_(farm) {}

  // Each handles one event. Returns the worker if it can be given leases with the answer.
  Worker* on(const SubmitResult& event, Actions& actions);
  Worker* on(const DeferResult& event, Actions& actions);

  // Whether the worker must be told of lost leases.
  static bool has_lost(const Worker& worker, const SubmitResult& event);

 private:
  core::Status validate(const Job& job, const SubmitResult& event) const;
  core::Status validate_lease(const Job& job, const SubmitResult& event) const;
  // Whether an earlier run may have extended the job by the item's samples, and lost that in a crash.
  bool was_extended_before(const Job& job, LeaseId lease, const WorkItem& item) const;
  // Whether the worker can be given leases with the answer to its result.
  bool takes_with_answer(const Worker& worker, const SubmitResult& event) const;
  void measure(Job& job, const SubmitResult& event);
  void note_counted(Job& job, const SubmitResult& event, std::uint64_t accepted, std::uint64_t audited,
                    Actions& actions);
  void note_refusal(Job& job, const SubmitResult& event, Actions& actions);
  void note_producer(Job& job, const WorkItem& item, const Producer& producer,
                     const Fingerprint& fingerprint);
  // Wakes the other holders of the item's samples, so that they hear at once that these are done.
  void spare_others(const Job& job, const WorkItem& item, const WorkerId& deliverer);

  FarmState& farm_;
  Leases& leases_;
  Jobs& jobs_;
  Losses& losses_;
  Auditing& auditing_;
  const Quorum quorum_;
};

}  // namespace tessera::scheduler
