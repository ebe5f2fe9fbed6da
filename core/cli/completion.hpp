// SPDX-License-Identifier: Apache-2.0
// Completion scripts of a program for shells, made of its options. Pure functions.
#pragma once

#include <optional>
#include <string>

#include "core/cli/option_table.hpp"

namespace tessera::cli {

std::string bash_completion(const CommandTable& table);
std::string zsh_completion(const CommandTable& table);
std::string fish_completion(const CommandTable& table);

// The script for the shell of this name: "bash", "zsh" or "fish". Empty for others.
std::optional<std::string> completion(const CommandTable& table, const std::string& shell);

}  // namespace tessera::cli
