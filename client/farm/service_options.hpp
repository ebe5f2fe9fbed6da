// SPDX-License-Identifier: Apache-2.0
// The options that say how a farm serves a job, the same for `submit` and `update`.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>

namespace tessera::client {

struct ServiceOptions {
  std::optional<std::int32_t> priority;
  std::optional<std::uint32_t> max_workers;  // 0 for as many as there are
};

// Adds --priority and --max-workers. `when_absent` tells in the help what holds where they are not given.
// Values are stored in `options` while the command line is parsed; `options` must live until then. A bad
// value ends parsing with a sentence that names the flag.
void add_service_options(CLI::App& command, const std::string& when_absent, ServiceOptions& options);

}  // namespace tessera::client
