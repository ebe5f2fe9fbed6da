// SPDX-License-Identifier: Apache-2.0
// Whether this process can have so many threads. OpenMP's own runtime ends the process where it cannot start
// one.
#pragma once

#include "core/base/error.hpp"

namespace tessera::core {

// Starts and ends `threads` - 1 threads beside the calling one. kResourceExhausted where one does not start.
Status check_threads(int threads);

}  // namespace tessera::core
