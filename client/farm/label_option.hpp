// SPDX-License-Identifier: Apache-2.0
// The option --label KEY=VALUE.
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>

namespace tessera::client {

using Labels = std::map<std::string, std::string>;

// Adds --label, which can be repeated. Values are stored in `labels` while the command line is parsed;
// `labels` must live until then. A text without a key ends parsing with a message that names the flag.
void add_label_option(CLI::App& command, const std::string& what, Labels& labels);

}  // namespace tessera::client
