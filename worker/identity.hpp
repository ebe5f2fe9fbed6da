// SPDX-License-Identifier: Apache-2.0
// The identity of a worker.
#pragma once

#include <cstdint>
#include <string>

namespace tessera::worker {

struct Identity {
  std::string worker_id{};  // 32 hexadecimal digits, random
  std::string name{};
  std::string version{};
  std::string determinism_fingerprint{};
  std::uint32_t threads = 1;
  std::string worker_key{};  // worker_id is its hash (proto/worker_key.hpp); never logged
};

}  // namespace tessera::worker
