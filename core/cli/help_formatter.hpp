// SPDX-License-Identifier: Apache-2.0
// The layout of --help for CLI11, which also keeps the help text of its command. See help.hpp.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <utility>

#include "core/cli/help.hpp"

namespace tessera::cli {

class HelpFormatter : public CLI::Formatter {
 public:
  explicit HelpFormatter(HelpText text) : text_(std::move(text)) {}

  const HelpText& text() const { return text_; }
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;

 private:
  HelpText text_;
};

}  // namespace tessera::cli
