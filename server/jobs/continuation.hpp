// SPDX-License-Identifier: Apache-2.0
// Whether workers of this farm can render more of a job.
#pragma once

#include <string>

#include "core/base/error.hpp"
#include "server/farm/job_record.hpp"

namespace tessera::jobs {

// FAILED_PRECONDITION if the job was begun by workers with another fingerprint than the farm's.
core::Status may_continue(const farm::JobRecord& record, const std::string& fingerprint);

}  // namespace tessera::jobs
