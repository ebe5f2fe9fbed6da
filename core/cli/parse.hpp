// SPDX-License-Identifier: Apache-2.0
// Parses a command line and reports its errors, with the same messages in every program.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace tessera::cli {

inline constexpr int kExitOk = 0;
inline constexpr int kExitFailed = 1;
inline constexpr int kExitUsage = 2;

// Returns the exit status if the program should exit now: 0 after --help and --version, which go to stdout,
// 2 after an error message on stderr, which suggests names for misspelt ones. Returns nothing if the program
// should run. `program` prefixes the message. PROGRAM --print-man-page and PROGRAM --print-completion SHELL
// print these files, for the build.
std::optional<int> parse(CLI::App& app, int argc, char** argv, const std::string& program);

// Prints "PROGRAM: error: MESSAGE" on stderr, with unprintable characters escaped. Returns kExitFailed, so
// that main() can return it.
int print_error(std::string_view program, std::string_view message);

// Adds the command `help` to a program with commands. `app` must live until the command line is parsed.
void add_help_command(CLI::App& app);

// Flushes stdout and returns `exit_code`, or 1 after a message if the output could not be written. A pipe
// whose reader has gone is not an error.
int flush_stdout(int exit_code, const std::string& program);

}  // namespace tessera::cli
