// SPDX-License-Identifier: Apache-2.0
// Replaces the worker's program by a new start in the same process: the only way to end threads that never
// return.
#pragma once

#include "worker/signals.hpp"
#include "worker/worker.hpp"

namespace tessera::worker {

// Options of a worker that restarts itself when a piece never ends. The new program is the same one with the
// arguments of main(), and keeps environment, folder, standard streams and process id. After a stop signal,
// or if the coordinator told the worker to stop, the process ends instead, and with status 1 if the system
// refuses. The wait
// before a restart grows with each start in a row that rendered nothing, whose number an environment variable
// passes on. The signals must outlive the worker.
Worker::Options with_self_restart(char** arguments, StopSignals& signals);

// Call it in main(): otherwise a restarted program would be listed as "exe".
void keep_program_name();

}  // namespace tessera::worker
