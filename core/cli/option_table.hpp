// SPDX-License-Identifier: Apache-2.0
// The commands and options of a program as data, of which --help, man pages and completions are made.
// Stateless.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "core/cli/help.hpp"

namespace tessera::cli {

struct OptionRow {
  std::string name{};         // "--spp", or "SCENE" for an argument
  std::string short_name{};   // "-o"; may be empty
  std::string value{};        // the placeholder of the value, such as "FILE"; empty for flags
  std::string description{};  // with the default
  std::string variable{};     // the environment variable of the default; may be empty
  bool is_required = false;
  bool is_repeatable = false;
};

// The words that a placeholder such as "none|aces|agx" lists; empty for others.
std::vector<std::string> choices_of(const std::string& placeholder);
// Whether the value may be left out: "[FILE]".
bool is_optional(const std::string& placeholder);
// Whether the placeholder stands for a file or folder, also for one that may be left out.
bool is_path(const std::string& placeholder);

struct OptionGroup {
  std::string title;  // "Options"
  std::vector<OptionRow> options;
};

struct CommandTable {
  std::string name{};       // "render"
  std::string full_name;    // "tessera render"
  std::string description;  // one line
  std::string group;        // the heading under which its program lists it
  std::vector<OptionRow> arguments{};
  std::vector<OptionGroup> groups{};  // none is empty
  HelpText text{};
  std::vector<CommandTable> commands{};
};

// The table of a program or command to which set_help() was applied.
CommandTable table_of(const CLI::App& app, const std::string& full_name);

// The environment variables of a table with what each is the default of. Those that are named by the rule of
// variable_of() are one row, that of the first option.
struct VariableRow {
  std::string name;         // "TESSERA_COORDINATOR"
  std::string description;  // "Default of --coordinator"
};
std::vector<VariableRow> variables_of(const CommandTable& table);

// "tessera render [OPTIONS] SCENE"; optional arguments are in brackets.
std::string usage_of(const CommandTable& table);

}  // namespace tessera::cli
