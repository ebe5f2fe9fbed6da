// SPDX-License-Identifier: Apache-2.0
// Ctrl-C and SIGTERM: the first asks for an orderly end, the second kills the process as if nobody listened.
#pragma once

namespace tessera::client {

// From now on the first SIGINT or SIGTERM is noted instead of ending the process, unless it was ignored.
// Signal handlers belong to the process: to be called once, by the command that runs.
void watch_for_interrupt();

// As if a signal was received.
void interrupt();

// Whether one was received. May be called from any thread.
bool interrupted();

}  // namespace tessera::client
