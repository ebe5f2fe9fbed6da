// SPDX-License-Identifier: Apache-2.0
// `tessera view`: an image in the terminal.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "client/screen/graphics.hpp"
#include "core/image/display.hpp"

namespace tessera::client {

struct ViewOptions {
  std::string image;  // a file; on a farm also a job
  core::DisplayOverrides display;
  std::optional<Graphics> graphics;  // empty: what the terminal has
  std::string layer{};               // of an .exr file or a job; empty: the image itself
  bool json = false;                 // prints facts about the image instead
};

// Adds the command with its options, which must live until the command line is parsed. Its callback is the
// caller's.
CLI::App* add_view_options(CLI::App& app, const std::string& what, ViewOptions& options);

// Shows an image file. The exit status.
int view_file(const ViewOptions& options);

// The command for files alone, of builds without a farm.
void add_view_command(CLI::App& app, int& exit_code);

}  // namespace tessera::client
