// SPDX-License-Identifier: Apache-2.0
// How long a worker renders samples that nobody wants any more before it assumes that they never end. Pure.
#pragma once

#include "worker/lease_tracker.hpp"

namespace tessera::worker {

// Twenty times the coordinator's lease time, or twice the time before the samples became unwanted if that is
// longer; at least 30 s and at most 360 lease times. By then the coordinator has counted a loss against the
// samples if a worker of this name has delivered before, or else the next workers have failed, too: a worker
// that is only slow loses nothing. A stopping worker waits for twenty lease times, or 30 s. Until this
// process has rendered a piece, the time doubles with each of the `failed_restarts` in a row that rendered
// none: slow workers finish in the end, and broken ones disturb the farm less and less.
Duration compute_hang_timeout(const UnwantedPiece& piece, int failed_restarts);

}  // namespace tessera::worker
