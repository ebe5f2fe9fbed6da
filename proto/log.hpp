// SPDX-License-Identifier: Apache-2.0
// The log of a program that runs for long: lines on stderr. What others chose (names, reasons) is in many of
// them, so each is made printable here, whoever writes it.
#pragma once

#include <string>

namespace tessera::proto {

// From now on spdlog writes to stderr, as `program`. For the beginning of main().
void log_to_stderr(const std::string& program);

}  // namespace tessera::proto
