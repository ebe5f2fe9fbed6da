// SPDX-License-Identifier: Apache-2.0
// Which work a worker may be given, and which of it comes first.
#pragma once

#include <optional>
#include <vector>

#include "server/scheduler/farm_state.hpp"

namespace tessera::scheduler {

class Eligibility {
 public:
  explicit Eligibility(const FarmState& farm) : farm_(farm) {}

  // Whether its samples can count for the job.
  static bool can_render(const Worker& worker, const Job& job);
  // The worker is given none since they stalled and it fetches the files.
  static bool awaits_files(const Worker& worker, const Job& job);
  // Whether the worker may be given leases of the job, whatever work there is.
  bool may_take(const Worker& worker, const Job& job) const;
  bool can_be_given(const Worker& worker, const Job& job, bool also_refused) const;
  bool can_audit(const Job& job, const Worker& worker) const;
  // An audit that another worker has in progress; empty if this worker may not do it.
  Portion audit_copy(const Job& job, const Worker& worker) const;
  std::vector<JobSnapshot> snapshots(const std::vector<JobNumber>& jobs) const;
  // The job of which the worker is given its next lease, as far as the indexes are up to date.
  std::optional<JobNumber> chosen(const Worker& worker, bool also_refused) const;
  // The number of workers that share the job's work.
  int sharers(const Job& job) const;
  // The expected time for all samples that it holds.
  double expected_seconds(const Worker& worker) const;

 private:
  // The worker has reported within lease_duration that it cannot build the scene.
  bool has_refused_lately(const Worker& worker, const Job& job) const;

  const FarmState& farm_;
};

}  // namespace tessera::scheduler
