// SPDX-License-Identifier: Apache-2.0
// The time of day.
#pragma once

#include <chrono>
#include <cstdint>

namespace tessera::base {

// Milliseconds since 1970-01-01 UTC.
inline std::int64_t wall_clock_ms() {
  const auto since_1970 = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::milliseconds>(since_1970).count();
}

}  // namespace tessera::base
