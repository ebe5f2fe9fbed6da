// What a worker says of itself.
#pragma once

#include <cstdint>
#include <string>

namespace tessera::worker {

struct Identity {
  std::string worker_id{};  // 32 hexadecimal digits, random
  std::string name{};
  std::string version{};
  std::string arithmetic_fingerprint{};
  std::uint32_t threads = 1;
};

}  // namespace tessera::worker
