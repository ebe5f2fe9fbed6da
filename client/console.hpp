// SPDX-License-Identifier: Apache-2.0
// Output of commands. Results go to stdout, everything else to stderr, with unprintable characters escaped
// (core/base/printable.hpp). Write errors do not end a command; cli::flush_stdout() reports lost results at
// the end.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"
#include "core/cli/help.hpp"
#include "core/cli/parse.hpp"

namespace tessera::client {

using cli::kExitFailed;
using cli::kExitOk;
using cli::kExitUsage;
// By Ctrl-C: returned by commands that watch for it; of others, which the signal ends, shells report the
// same.
inline constexpr int kExitInterrupted = 130;

// The section "Exit status" of commands without special statuses.
extern const std::vector<cli::HelpText::ExitStatus> kUsualExitStatuses;

// Writes `text` to stdout unchanged, and flushes.
void print_result(std::string_view text);

// Whether any output of print_result() could not be written.
bool results_are_lost();

// Prints "tessera: error: MESSAGE". Returns kExitFailed, so that a command can return it.
int print_error(std::string_view message);
int print_error(const core::Error& error);

// Prints "tessera: warning: MESSAGE".
void print_warning(std::string_view message);

// Prints each message as a warning.
void print_warnings(const std::vector<std::string>& messages);

// Warns that the scene at `path` has no light and its image will be black.
void warn_about_darkness(std::string_view scene_path);

// Warns that the integrator ignores the participating media of the scene at `path`.
void warn_about_ignored_media(std::string_view scene_path);

// Warns that several frames were asked for of a scene that has no keyframes.
void warn_about_still_frames(std::string_view scene_path);

// Prints "Try: COMMAND".
void print_hint(std::string_view command);

// A line on stderr that is neither an error nor a warning.
void print_note(std::string_view line);

// Seconds on a monotonic clock with an arbitrary origin.
double steady_seconds();

}  // namespace tessera::client
