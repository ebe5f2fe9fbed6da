// SPDX-License-Identifier: Apache-2.0
// The options that control how a farm serves a job, shared by `submit` and `update`.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>

namespace tessera::client {

struct ServiceOptions {
  std::optional<std::int32_t> priority;
  std::optional<std::uint32_t> max_workers;  // 0 means no limit
};

// Adds --priority and --max-workers. `when_absent` describes in the help the default if they are not given.
// Values are stored in `options` while the command line is parsed; `options` must live until then. A bad
// value ends parsing with a message that names the flag.
void add_service_options(CLI::App& command, const std::string& when_absent, ServiceOptions& options);

}  // namespace tessera::client
