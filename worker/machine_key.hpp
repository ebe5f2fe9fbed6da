// SPDX-License-Identifier: Apache-2.0
// The random key by which a coordinator recognises this machine's workers (proto/worker_key.hpp).
#pragma once

#include <string>

#include "core/base/error.hpp"

namespace tessera::worker {

// Reads the file worker.key in this folder. If it is missing, creates it, readable by this user only. Workers
// that start at the same time get the same key. Errors name the file.
core::Result<std::string> machine_key(const std::string& folder);

// A new key for one process of that machine.
std::string new_worker_key(const std::string& machine_key);

}  // namespace tessera::worker
