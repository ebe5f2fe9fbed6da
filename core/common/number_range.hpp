// SPDX-License-Identifier: Apache-2.0
// Numbers of the command line with a minimum and a maximum.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <string>

namespace tessera::common {

// For CLI::Option::check. It reads numbers as CLI::Range does, but also refuses "nan".
template <typename T>
CLI::Validator number_between(T least, T most) {
  const auto problem = [least, most](const std::string& text) {
    T value{};
    if (CLI::detail::lexical_cast(text, value) && value >= least && value <= most) return std::string();
    return fmt::format("must be a number from {} to {}; got '{}'", least, most, text);
  };
  return CLI::Validator(problem, "");
}

}  // namespace tessera::common
