// SPDX-License-Identifier: Apache-2.0
// The layout of --help, the same for every program and command: a summary, usage, commands, arguments and
// options in two columns, environment variables, and the sections of HelpText.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace tessera::cli {

// The help text besides the options. Empty sections are left out. Text is wrapped, except for lines that
// begin with a space.
struct HelpText {
  std::string notes{};
  struct ExitStatus {
    int status;
    std::string meaning;
  };
  std::vector<ExitStatus> exit_statuses{};
  std::vector<std::string> examples{};  // command lines
  // Arguments that the command requires though the parser does not, since it may take them for the value of
  // an option.
  std::vector<std::string> required_arguments{};
};

// Applies this layout and text to `app`. Commands added later inherit the layout.
void set_help(CLI::App& app, const HelpText& text);

// Accepts the same paths as CLI::ExistingFile and CLI::ExistingDirectory together, but adds no text to
// --help.
CLI::Validator existing_file();
CLI::Validator existing_folder();

}  // namespace tessera::cli
