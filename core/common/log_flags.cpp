// SPDX-License-Identifier: Apache-2.0
#include "core/common/log_flags.hpp"

#include <array>
#include <string>
#include <utility>

namespace tessera::common {

namespace {

constexpr std::array kLevels{std::pair("debug", spdlog::level::debug), std::pair("info", spdlog::level::info),
                             std::pair("warning", spdlog::level::warn),
                             std::pair("error", spdlog::level::err)};
constexpr std::array kFormats{std::pair("text", LogFormat::kText), std::pair("json", LogFormat::kJson)};

// Adds an option whose value is the name of one of `choices`.
template <typename Choices, typename Value>
CLI::Option* add_choice(CLI::App& command, const char* flag, const Choices& choices, Value& value,
                        const char* what) {
  const auto parse = [flag, &choices, &value](const std::string& text) {
    std::string names;
    for (const auto& [name, choice] : choices) {
      if (text == name) {
        value = choice;
        return;
      }
      names += (names.empty() ? "" : ", ") + std::string(name);
    }
    throw CLI::ValidationError(flag, "must be one of " + names + ", got '" + text + "'");
  };
  return command.add_option_function<std::string>(flag, parse, what);
}

}  // namespace

void add_log_flags(CLI::App& command, LogOptions& options) {
  add_choice(command, "--log-level", kLevels, options.level,
             "Log lines of this level and above: debug, info, warning or error")
      ->type_name("LEVEL")
      ->default_str("info");
  add_choice(command, "--log-format", kFormats, options.format,
             "Write log lines as text or as JSON objects: text or json")
      ->type_name("FORMAT")
      ->default_str("text");
}

}  // namespace tessera::common
