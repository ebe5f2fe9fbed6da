// SPDX-License-Identifier: Apache-2.0
// The commands that do not use a farm. Each adds itself to the command line; if it is called, it runs and
// stores the exit status of the process.
#pragma once

#include <CLI/CLI.hpp>

namespace tessera::client {

void add_render_command(CLI::App& app, int& exit_code);
void add_rerender_command(CLI::App& app, int& exit_code);
void add_import_command(CLI::App& app, int& exit_code);
void add_info_command(CLI::App& app, int& exit_code);
void add_compare_command(CLI::App& app, int& exit_code);
void add_schema_command(CLI::App& app, int& exit_code);

}  // namespace tessera::client
