// SPDX-License-Identifier: Apache-2.0
// Sets up stdin, stdout and stderr for the programs that people start: a stream that is closed, full or a
// pipe without a reader makes writes fail, and never ends the process. So does a file at its limit.
#pragma once

namespace tessera::core {

// Call this first in main(), before files are opened and threads started. It ignores SIGPIPE and SIGXFSZ
// (ulimit -f), and opens /dev/null for each closed descriptor from 0 to 2, so that no file takes its number.
// Output to a closed stderr is discarded; writes to a closed stdout fail.
void prepare_standard_streams();

// Whether `descriptor` is a pipe or socket whose other end is closed.
bool reader_is_gone(int descriptor);

}  // namespace tessera::core
