// Runs the built `tessera`, for what can only be seen from outside: exit statuses, streams and signals.
#pragma once

#include <string>
#include <vector>

namespace tessera::client {

struct ProcessResult {
  int exit_status = -1;  // -1 if ended by a signal
  std::string out, err;
};

// Runs to the end with stdout and stderr in files, or with stdout to this device.
ProcessResult run_tessera(const std::vector<std::string>& arguments, const char* stdout_device = nullptr);

// Runs with stderr on a terminal of its own; sends `signal` when `text` has appeared there.
ProcessResult run_on_terminal_and_signal(const std::vector<std::string>& arguments, const std::string& text,
                                         int signal);

}  // namespace tessera::client
