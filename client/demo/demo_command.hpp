// SPDX-License-Identifier: Apache-2.0
// `tessera demo`: a farm in this process for a first look, with a scene that it renders.
#pragma once

#include <CLI/CLI.hpp>

namespace tessera::client {

void add_demo_command(CLI::App& app, int& exit_code);

}  // namespace tessera::client
