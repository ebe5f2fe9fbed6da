// SPDX-License-Identifier: Apache-2.0
// What farm_commands.cpp puts together, one function for each file.
#pragma once

#include <CLI/CLI.hpp>

namespace tessera::client {

void add_submit_command(CLI::App& app, int& exit_code);
void add_watch_command(CLI::App& app, int& exit_code);
void add_image_command(CLI::App& app, int& exit_code);
void add_list_commands(CLI::App& app, int& exit_code);    // jobs, job, workers
void add_change_commands(CLI::App& app, int& exit_code);  // cancel, pause, resume, extend, update, delete

}  // namespace tessera::client
