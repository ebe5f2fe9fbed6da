// SPDX-License-Identifier: Apache-2.0
// Downloads images of jobs.
#pragma once

#include <string>
#include <vector>

#include "client/farm/farm.hpp"
#include "core/image/display.hpp"

namespace tessera::client {

// Fetches the job's image once for each path, in the format of its extension, and writes it atomically. PNG
// files use the job's display settings with the overrides applied. Returns the job when the last image was
// taken. Errors name the path.
core::Result<v1::Job> download_pictures(Farm& farm, const std::string& job_id,
                                        const std::vector<std::string>& paths,
                                        const core::DisplayOverrides& display);

// The same for a job that was DONE, with its final images. If it is no longer DONE, writes nothing and
// returns the job: a coordinator that crashed with a full disk, or that quarantines a worker, may run it
// again.
core::Result<v1::Job> download_finished_pictures(Farm& farm, const std::string& job_id,
                                                 const std::vector<std::string>& paths);

}  // namespace tessera::client
