// SPDX-License-Identifier: Apache-2.0
// How --help looks, the same for every program and command: a summary, usage, commands, arguments and options
// in two columns, environment variables, and the sections of HelpText.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace tessera::cli {

// What a help says besides the options. Empty sections are left out. Text is wrapped, but for lines that
// begin with a space.
struct HelpText {
  std::string notes;
  struct ExitStatus {
    int status;
    std::string meaning;
  };
  std::vector<ExitStatus> exit_statuses;
  std::vector<std::string> examples;  // command lines
};

// Gives `app` this look and this text. Commands that are added to it later have the same look.
void set_help(CLI::App& app, const HelpText& text);

// The paths that CLI::ExistingFile and CLI::ExistingDirectory take, without their words in --help.
CLI::Validator existing_file();
CLI::Validator existing_folder();

}  // namespace tessera::cli
