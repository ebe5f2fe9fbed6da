// SPDX-License-Identifier: Apache-2.0
// Uploads of the files of a bundle: small ones in batches, large ones in streams that continue after an
// interruption. Files are read in chunks. Blocks, and retries while the coordinator restarts or asks to wait.
#pragma once

#include <string>
#include <vector>

#include "client/farm/bundle.hpp"
#include "client/farm/farm.hpp"

namespace tessera::client {

// Sends the files that the coordinator lacks. Fails also if a file has changed since it was bundled.
core::Status upload_missing(Farm& farm, const LocalBundle& bundle);

// Sends the files that a refused call names (core::ErrorDetails::missing). If it may not name all, the
// coordinator is asked.
core::Status upload_named(Farm& farm, const LocalBundle& bundle, const std::vector<std::string>& names);

}  // namespace tessera::client
