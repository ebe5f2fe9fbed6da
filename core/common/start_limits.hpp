// SPDX-License-Identifier: Apache-2.0
// Checks at the start whether the limits of this process suffice. Threads and gRPC end a process without a
// message, or wait forever, if they cannot have what they need. Stateless.
#pragma once

#include <string_view>

#include "core/base/error.hpp"

namespace tessera::common {

// About as many threads as they have, without any connection and without those that render.
inline constexpr int kCoordinatorThreads = 40, kWorkerThreads = 16;

// Whether the process may use a gibibyte of addresses, and starts and ends `threads` threads. Returns
// kResourceExhausted with the limit to raise; `what` is "a worker".
core::Status check_start_limits(std::string_view what, int threads);

}  // namespace tessera::common
