// SPDX-License-Identifier: Apache-2.0
// The commands that use a farm: submit, jobs, job, watch, image, cancel, pause, resume, extend, delete,
// workers. The one that is called runs and stores the exit status of the process.
#pragma once

#include <CLI/CLI.hpp>

namespace tessera::client {

void add_farm_commands(CLI::App& app, int& exit_code);

}  // namespace tessera::client
