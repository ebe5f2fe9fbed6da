// SPDX-License-Identifier: Apache-2.0
// Parses a command line and says what is wrong with it, in the same words for every program.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

namespace tessera::cli {

inline constexpr int kExitOk = 0;
inline constexpr int kExitFailed = 1;
inline constexpr int kExitUsage = 2;

// The exit status to end with at once: 0 after --help and --version, which go to stdout, 2 after a message on
// stderr. Nothing where the program is to run. `program` begins the message.
std::optional<int> parse(CLI::App& app, int argc, char** argv, const std::string& program);

// `exit_code`, unless the results did not get to where stdout goes: then 1, after a message. That nobody
// reads a pipe any more is no failure.
int flush_stdout(int exit_code, const std::string& program);

}  // namespace tessera::cli
