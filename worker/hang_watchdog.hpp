// SPDX-License-Identifier: Apache-2.0
// How long samples that nobody wants any more may go on before they are taken for endless. Pure.
#pragma once

#include "worker/lease_tracker.hpp"

namespace tessera::worker {

// Twenty times the coordinator's lease time, and twice as long as they had been rendered before; 30 s at
// least, 360 times the lease time at most. By then the coordinator has counted this worker, if its name has
// delivered before, or those that were given the samples next have failed, too: a worker that is only slow
// loses nothing. A worker that is to stop waits for twenty lease times, or 30 s. Otherwise twice as long for
// each of the `failed_restarts` of this program in a row that rendered no piece at all, as long as this one
// has not either: whoever is slow gets through in the end, and whoever is broken troubles the farm less and
// less.
Duration compute_hang_timeout(const UnwantedPiece& piece, int failed_restarts);

}  // namespace tessera::worker
