// SPDX-License-Identifier: Apache-2.0
// stdin, stdout and stderr as every program of Tessera wants them: a stream that is closed, full or a pipe
// without a reader makes writes fail, and never ends the process.
#pragma once

namespace tessera::core {

// To be called first in main(), before files are opened and threads started. Ignores SIGPIPE. Opens /dev/null
// for each of the descriptors 0 to 2 that is closed, so that no file takes its place: stderr then swallows
// what is written, and writes to stdout fail as they would have.
void prepare_standard_streams();

// Whether `descriptor` is a pipe or socket whose other end is closed.
bool reader_is_gone(int descriptor);

}  // namespace tessera::core
