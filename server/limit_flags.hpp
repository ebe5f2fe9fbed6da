// SPDX-License-Identifier: Apache-2.0
// The coordinator's limits as options of its command line.
#pragma once

#include <CLI/CLI.hpp>

#include "server/limits.hpp"

namespace tessera::server {

// The group "Limits". `limits` are filled in while the command line is parsed, and must live until then.
void add_limit_flags(CLI::App& app, Limits& limits);

}  // namespace tessera::server
