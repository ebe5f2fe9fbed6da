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

}  // namespace tessera::client
