// What a process that reads hostile files may use.
#pragma once

#include <cstdint>

#include "core/base/error.hpp"

namespace tessera::validator {

struct Limits {
  std::uint64_t memory_bytes = std::uint64_t{16} << 30;  // address space
  std::uint64_t cpu_seconds = 300;
};

// For this process, for good: beyond them allocations fail, and the process is killed. No core files, and no
// files written but what is open already and small.
core::Status apply_limits(const Limits& limits);

}  // namespace tessera::validator
