// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/job_calls.hpp"

#include <fmt/format.h>

#include <utility>

namespace tessera::rpc {

core::Result<v1::Job> submit(server::Coordinator& coordinator, ValidationQueue& validations,
                             const v1::SubmitJobRequest& request, const auth::Principal& caller) {
  jobs::JobService& jobs = coordinator.jobs();
  if (auto known = jobs.find_submission(request.request_id(), caller.name)) return *std::move(known);
  auto place = validations.reserve(caller.key);
  if (!place) return core::fail(place.error());
  auto job = jobs.submit(request, caller.name, caller.machine);
  if (job) validations.post(caller.key, *std::move(place), job->id());
  return job;
}

core::Status may_change(server::Coordinator& coordinator, const auth::Principal& caller,
                        const std::string& job_id) {
  if (caller.role == auth::Role::kAdmin) return {};
  const auto job = coordinator.jobs().summary(job_id);
  if (!job) return core::fail(job.error());
  if (job->owner() == caller.name) return {};
  return core::fail(core::ErrorCode::kPermissionDenied,
                    fmt::format("job {} was submitted by '{}': only they and administrators may change it",
                                job_id, job->owner()));
}

}  // namespace tessera::rpc
