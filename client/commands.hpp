// SPDX-License-Identifier: Apache-2.0
// The commands that need no farm. Each adds itself to the command line; when it is the one that was called,
// it runs and stores the process's exit status.
#pragma once

#include <CLI/CLI.hpp>

namespace tessera::client {

void add_render_command(CLI::App& app, int& exit_code);
void add_compare_command(CLI::App& app, int& exit_code);
void add_schema_command(CLI::App& app, int& exit_code);

}  // namespace tessera::client
