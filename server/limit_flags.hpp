// SPDX-License-Identifier: Apache-2.0
// The coordinator's limits as options of its command line.
#pragma once

#include <CLI/CLI.hpp>

#include "server/limits.hpp"

namespace tessera::server {

// Adds the option group "Limits". `limits` must live until the command line is parsed, which fills it in.
void add_limit_flags(CLI::App& app, Limits& limits);

}  // namespace tessera::server
