// SPDX-License-Identifier: Apache-2.0
#include "server/jobs/continuation.hpp"

#include <fmt/format.h>

namespace tessera::jobs {

core::Status may_continue(const farm::JobRecord& record, const std::set<std::string>& fingerprints) {
  if (record.arithmetic.empty() || fingerprints.contains(record.arithmetic)) return {};
  return core::fail(
      core::ErrorCode::kFailedPrecondition,
      fmt::format(
          "job {} was rendered by workers of another build (fingerprint {}; this farm's is {}), and "
          "its image cannot be continued by these: submit the scene again, or start the coordinator with "
          "--accept-fingerprint {} and workers of that build",
          record.spec->id(), record.arithmetic, fmt::join(fingerprints, " and "), record.arithmetic));
}

core::Status answer_of_finished(const farm::JobSnapshot& job, const scheduler::Event& event) {
  const scheduler::JobView& view = job.view;
  scheduler::Scheduler scheduler({});
  scheduler::IntervalSet all;
  all.add({0, view.shape.spp});
  const scheduler::RestoreJob job_alone{
      view.id, {1, 1, view.shape.spp}, view.priority, view.state, view.failure, {all}, view.max_workers,
      {},      view.failure_details};
  if (auto known = scheduler.handle(job_alone, {}).status; !known) return known;
  return scheduler.handle(event, {}).status;
}

}  // namespace tessera::jobs
