// SPDX-License-Identifier: Apache-2.0
// How workers prove who they are without anything set up beforehand: ids are hashes of random bytes that the
// worker alone knows and shows with its calls. Pure functions.
#pragma once

#include <cstddef>
#include <string>

namespace tessera::proto {

// A worker's key: that of its machine, then bytes of the process.
inline constexpr std::size_t kMachineKeyBytes = 32;
inline constexpr std::size_t kWorkerKeyBytes = kMachineKeyBytes + 16;

// 32 lower-case hexadecimal digits: the id of the worker whose key this is.
std::string worker_id_of(const std::string& worker_key);

// 32 lower-case hexadecimal digits that tell its machine from others, and nothing of the machine's key. Empty
// for what is no worker's key.
std::string client_key(const std::string& worker_key);

}  // namespace tessera::proto
