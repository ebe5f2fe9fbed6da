// SPDX-License-Identifier: Apache-2.0
// The log of a long-running program: lines on stderr. Many contain texts of others (names, reasons), so every
// line is made printable here.
#pragma once

#include <string>

namespace tessera::proto {

// From now on spdlog writes to stderr, as `program`. Call it at the beginning of main().
void log_to_stderr(const std::string& program);

}  // namespace tessera::proto
