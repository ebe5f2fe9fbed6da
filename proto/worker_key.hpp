// SPDX-License-Identifier: Apache-2.0
// Proof of a worker's identity without any setup: its id is a hash of random bytes that only the worker knows
// and sends with its calls. Pure functions.
#pragma once

#include <cstddef>
#include <string>

namespace tessera::proto {

// A worker's key consists of that of its machine and that of the process.
inline constexpr std::size_t kMachineKeyBytes = 32;
inline constexpr std::size_t kWorkerKeyBytes = kMachineKeyBytes + 16;

// The id of the worker with this key: 32 lower-case hexadecimal digits.
std::string worker_id_of(const std::string& worker_key);

// Identifies the machine without revealing its key: 32 lower-case hexadecimal digits. Empty if it is no
// worker's key.
std::string client_key(const std::string& worker_key);

}  // namespace tessera::proto
