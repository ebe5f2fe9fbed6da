// SPDX-License-Identifier: Apache-2.0
// Measures events of the scheduler that concern many workers or a large image at once.
#pragma once

namespace tessera::scheduler {

// Prints a table: the CPU time of each such event, and of the ticks that finish what it has left. Takes some
// minutes and 2 GB of memory.
void print_rare_events();

}  // namespace tessera::scheduler
