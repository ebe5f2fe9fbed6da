// SPDX-License-Identifier: Apache-2.0
// The commands that speak to a farm: submit, jobs, job, watch, image, cancel, pause, resume, extend, delete,
// workers. When one of them is the one that was called, it runs and stores the process's exit status.
#pragma once

#include <CLI/CLI.hpp>

namespace tessera::client {

void add_farm_commands(CLI::App& app, int& exit_code);

}  // namespace tessera::client
