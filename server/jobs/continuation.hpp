// SPDX-License-Identifier: Apache-2.0
// Whether a job can go on.
#pragma once

#include <set>
#include <string>

#include "core/base/error.hpp"
#include "server/farm/job_record.hpp"

namespace tessera::jobs {

// FAILED_PRECONDITION if the job was begun by workers with a fingerprint that the farm does not accept.
core::Status may_continue(const farm::JobRecord& record, const std::set<std::string>& fingerprints);

// What the scheduler answers to a change of a job that is finished and in the store alone:
// FAILED_PRECONDITION or INVALID_ARGUMENT, unless the change changes nothing or extends a done job.
core::Status answer_of_finished(const farm::JobSnapshot& job, const scheduler::Event& event);

}  // namespace tessera::jobs
