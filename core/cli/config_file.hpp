// SPDX-License-Identifier: Apache-2.0
// Options from files and from the environment. Precedence: command line, environment variables, file,
// defaults.
//
// A file has one option a line, `NAME = VALUE` or `NAME` for a flag, with the names of the command line
// without dashes. A value reaches to the end of its line and is not quoted. Empty lines and lines that begin
// with # are skipped. An option that can be repeated may have several lines.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"

namespace tessera::cli {

struct ConfigLine {
  int number = 0;  // from 1
  std::string name{};
  std::optional<std::string> value{};  // empty: the line has no '='

  bool operator==(const ConfigLine&) const = default;
};

// The lines of a file that set options. INVALID_ARGUMENT with the number of the line that cannot be read.
core::Result<std::vector<ConfigLine>> parse_config(std::string_view text);

// Adds --config FILE. A file may set all options of `app` but those that are not configurable. Errors name
// file and line. `app` must live until the command line is parsed.
void add_config_option(CLI::App& app);

// "TESSERA_WORKER_CACHE_GIB" for the option --cache-gib of tessera-worker.
std::string variable_of(const std::string& program, const std::string& option);

// Gives each configurable option of a program with --config the variable of this name, unless it has another.
void add_environment_variables(CLI::App& app);

}  // namespace tessera::cli
