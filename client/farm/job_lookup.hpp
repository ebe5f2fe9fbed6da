// SPDX-License-Identifier: Apache-2.0
// Finds jobs by what a user typed. Stateless.
#pragma once

#include <cstddef>
#include <string>

#include "client/farm/farm.hpp"

namespace tessera::client {

// Adds the argument JOB for find_job().
void add_job_argument(CLI::App& command, std::string& id_or_prefix);

// The job with this id, or the only one whose id starts with it.
core::Result<v1::Job> find_job(Farm& farm, const std::string& id_or_prefix);

// All jobs that match the request, newest first: the pages of the list together, up to `limit` jobs.
core::Result<v1::ListJobsResponse> list_jobs(Farm& farm, v1::ListJobsRequest request, std::size_t limit);

}  // namespace tessera::client
