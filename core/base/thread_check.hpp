// SPDX-License-Identifier: Apache-2.0
// Checks whether this process can start a number of threads. OpenMP's runtime ends the process if it cannot
// start one.
#pragma once

#include "core/base/error.hpp"

namespace tessera::core {

// Starts and ends `threads` - 1 threads beside the calling one. Returns kResourceExhausted if one fails to
// start.
Status check_threads(int threads);

}  // namespace tessera::core
