// SPDX-License-Identifier: Apache-2.0
// Runs the built `tessera`, for what can only be seen from outside: exit statuses, streams and signals.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace tessera::client {

struct ProcessResult {
  int exit_status = -1;  // -1 if ended by a signal
  std::string out, err;
};

// Runs to the end with stdout and stderr in files.
ProcessResult run_tessera(const std::vector<std::string>& arguments);

// The same after `prepare` has changed the process that becomes tessera: its streams, its limits.
ProcessResult run_tessera_after(const std::function<void()>& prepare,
                                const std::vector<std::string>& arguments);

// Runs with stderr on a terminal of its own; sends `signal` when `text` has appeared there.
ProcessResult run_on_terminal_and_signal(const std::vector<std::string>& arguments, const std::string& text,
                                         int signal);

// Runs with stdout and stderr in files; sends `signal` when `condition` holds, which is asked again and again
// while the program runs.
ProcessResult run_tessera_and_signal(const std::vector<std::string>& arguments,
                                     const std::function<bool()>& condition, int signal);

// Runs with stdout in a file; when `text` has appeared on stderr, calls `use` with all of stderr so far, and
// then sends `signal`. There is no desktop that could open a browser.
ProcessResult run_tessera_and_use(const std::vector<std::string>& arguments, const std::string& text,
                                  const std::function<void(const std::string& err)>& use, int signal);

}  // namespace tessera::client
