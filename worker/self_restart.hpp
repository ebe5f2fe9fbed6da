// SPDX-License-Identifier: Apache-2.0
// A new start of this program in the same process: the way out for a worker with threads that nothing ends.
#pragma once

#include "worker/signals.hpp"
#include "worker/worker.hpp"

namespace tessera::worker {

// Of a worker that has this process replaced when a piece of it never ends: by the same program, with the
// arguments that main() was given and the same environment, folder, standard streams and process id. Ends it
// instead after a signal to stop, and with status 1 if the coordinator or the system refuses. Waits longer
// with each start in a row that rendered nothing, which it leaves to the next in an environment variable. The
// signals must outlive the worker.
Worker::Options with_self_restart(char** arguments, StopSignals& signals);

// To be called in main(), since a program that was started anew would be listed as "exe" otherwise.
void keep_program_name();

}  // namespace tessera::worker
