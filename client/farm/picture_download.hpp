// SPDX-License-Identifier: Apache-2.0
// Pictures of jobs into files.
#pragma once

#include <string>
#include <vector>

#include "client/farm/farm.hpp"
#include "core/image/display.hpp"

namespace tessera::client {

// Fetches the job's picture once for each path, in the format of its ending, PNG files as the job says but
// for the overrides, and writes it whole or not at all. Answers with the job when the last picture was taken.
// Errors name the path.
core::Result<v1::Job> download_pictures(Farm& farm, const std::string& job_id,
                                        const std::vector<std::string>& paths,
                                        const core::DisplayOverrides& display);

// The same of a job that was DONE, as it asked for its pictures to be. Writes nothing that is not, and answers
// with the job as it is then: a coordinator that crashed with a full disk, or that puts a worker aside, lets
// it run again.
core::Result<v1::Job> download_finished_pictures(Farm& farm, const std::string& job_id,
                                                 const std::vector<std::string>& paths);

}  // namespace tessera::client
