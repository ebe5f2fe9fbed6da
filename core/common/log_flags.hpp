// SPDX-License-Identifier: Apache-2.0
// The command-line options for logs, shared by coordinator and worker.
#pragma once

#include <CLI/CLI.hpp>

#include "core/common/log.hpp"

namespace tessera::common {

// Adds --log-level and --log-format. `options` must live until the command line is parsed, which fills it in.
void add_log_flags(CLI::App& command, LogOptions& options);

}  // namespace tessera::common
