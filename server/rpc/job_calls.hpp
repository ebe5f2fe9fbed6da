// SPDX-License-Identifier: Apache-2.0
// What calls for jobs check besides the service for jobs, however they arrive. Stateless; thread-safe. They
// block for the disk.
#pragma once

#include <string>

#include "core/base/error.hpp"
#include "server/auth/principal.hpp"
#include "server/coordinator.hpp"
#include "server/rpc/validation_queue.hpp"
#include "tessera/v1/render_service.pb.h"

namespace tessera::rpc {

// Submits a job and enters its scene among those to be validated. A repeated call is answered also when no
// more scenes may wait. Errors are those of JobService::submit() and ValidationQueue::reserve().
core::Result<v1::Job> submit(server::Coordinator& coordinator, ValidationQueue& validations,
                             const v1::SubmitJobRequest& request, const auth::Principal& caller);

// PERMISSION_DENIED unless the job is the caller's, or the caller is an administrator. NOT_FOUND: no such
// job.
core::Status may_change(server::Coordinator& coordinator, const auth::Principal& caller,
                        const std::string& job_id);

}  // namespace tessera::rpc
