// SPDX-License-Identifier: Apache-2.0
// The functions that farm_commands.cpp combines, one for each source file.
#pragma once

#include <CLI/CLI.hpp>

namespace tessera::client {

void add_submit_command(CLI::App& app, int& exit_code);
void add_watch_command(CLI::App& app, int& exit_code);
void add_image_command(CLI::App& app, int& exit_code);
void add_job_view_command(CLI::App& app, int& exit_code);  // view, of files and jobs
void add_list_commands(CLI::App& app, int& exit_code);    // jobs, job, workers, server
void add_change_commands(CLI::App& app, int& exit_code);  // cancel, pause, resume, extend, update, delete
void add_fleet_commands(CLI::App& app, int& exit_code);   // quarantine, drain

}  // namespace tessera::client
