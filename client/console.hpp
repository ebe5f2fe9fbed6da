// SPDX-License-Identifier: Apache-2.0
// What a command prints. Results go to stdout, everything else goes to stderr, made printable
// (core/base/printable.hpp). Text that cannot be written is lost and ends nothing; cli::flush_stdout()
// reports lost results at the end.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/cli/help.hpp"
#include "core/cli/parse.hpp"
#include "core/base/error.hpp"

namespace tessera::client {

using cli::kExitFailed;
using cli::kExitOk;
using cli::kExitUsage;
inline constexpr int kExitInterrupted = 130;

// The section "Exit status" of commands whose statuses mean nothing special.
extern const std::vector<cli::HelpText::ExitStatus> kUsualExitStatuses;

// Writes `text` to stdout as it is, and flushes.
void print_result(std::string_view text);

// Whether something that print_result() was given could not be written.
bool results_are_lost();

// "tessera: error: MESSAGE". Returns kExitFailed, so that a command can end with it.
int print_error(std::string_view message);
int print_error(const core::Error& error);

// "tessera: warning: MESSAGE"
void print_warning(std::string_view message);

// Each of them, as what is told about a scene's files.
void print_warnings(const std::vector<std::string>& messages);

// That the scene at `path` gives no light and its image will be black.
void warn_about_darkness(std::string_view scene_path);

// "Try: COMMAND"
void print_hint(std::string_view command);

// A line on stderr that is neither an error nor a warning.
void print_note(std::string_view line);

// Seconds on a clock that never runs backwards; its zero means nothing.
double steady_seconds();

}  // namespace tessera::client
