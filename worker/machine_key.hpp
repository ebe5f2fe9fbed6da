// SPDX-License-Identifier: Apache-2.0
// The random bytes by which a coordinator knows this machine's workers again (proto/worker_key.hpp).
#pragma once

#include <string>

#include "core/base/error.hpp"

namespace tessera::worker {

// Those in the file worker.key of this folder, which is made where it is missing, for this user alone to
// read. Workers that start at the same time get the same. Errors name the file.
core::Result<std::string> machine_key(const std::string& folder);

// A key for one process of that machine.
std::string new_worker_key(const std::string& machine_key);

}  // namespace tessera::worker
