// SPDX-License-Identifier: Apache-2.0
#include "core/cli/option_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <sstream>
#include <string_view>

#include "core/cli/config_file.hpp"
#include "core/cli/help_formatter.hpp"

namespace tessera::cli {
namespace {

bool is_argument(const CLI::Option* option) {
  return option->get_positional();
}

std::string value_name(const CLI::Option* option) {
  if (!option->get_option_text().empty()) return option->get_option_text();
  return option->get_items_expected_max() == 0 ? "" : option->get_type_name();
}

std::string description_of(const CLI::Option* option) {
  const std::string value = option->get_default_str();
  return option->get_description() + (value.empty() ? "" : fmt::format(" [default: {}]", value));
}

OptionRow row_of(const CLI::Option* option) {
  if (is_argument(option)) {
    const std::string name = option->get_name(true);
    return {.name = name,
            .value = name,
            .description = description_of(option),
            .is_required = option->get_required()};
  }
  const bool has_short = !option->get_snames().empty();
  const std::string value = value_name(option);
  return {.name = "--" + option->get_lnames().front(),
          .short_name = has_short ? "-" + option->get_snames().front() : "",
          .value = value,
          .description = description_of(option),
          .variable = option->get_envname(),
          .is_required = option->get_required(),
          .is_repeatable = !value.empty() && option->get_expected_max() > 1};
}

// Help and version stand last.
OptionGroup group_of(const CLI::App& app, const std::string& title) {
  auto options = app.get_options(
      [&](const CLI::Option* option) { return !is_argument(option) && option->get_group() == title; });
  std::stable_partition(options.begin(), options.end(), [&](const CLI::Option* option) {
    return option != app.get_help_ptr() && option != app.get_version_ptr();
  });
  OptionGroup group{.title = title, .options = {}};
  for (const CLI::Option* option : options) group.options.push_back(row_of(option));
  return group;
}

}  // namespace

std::vector<std::string> choices_of(const std::string& placeholder) {
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyz0123456789-|";
  if (placeholder.find('|') == std::string::npos ||
      placeholder.find_first_not_of(kLetters) != std::string::npos)
    return {};
  std::vector<std::string> words;
  std::istringstream text(placeholder);
  for (std::string word; std::getline(text, word, '|');) words.push_back(word);
  return words;
}

bool is_optional(const std::string& placeholder) {
  return placeholder.starts_with('[') && placeholder.ends_with(']');
}

bool is_path(const std::string& placeholder) {
  constexpr std::array<std::string_view, 6> kPaths{"FILE", "DIR", "SCENE", "A", "B", "IMAGE"};
  const std::string name =
      is_optional(placeholder) ? placeholder.substr(1, placeholder.size() - 2) : placeholder;
  return std::find(kPaths.begin(), kPaths.end(), name) != kPaths.end();
}

CommandTable table_of(const CLI::App& app, const std::string& full_name) {
  CommandTable table{.name = app.get_name(),
                     .full_name = full_name,
                     .description = app.get_description(),
                     .group = app.get_group()};
  for (const CLI::Option* option : app.get_options(is_argument)) table.arguments.push_back(row_of(option));
  for (const std::string& title : app.get_groups()) {
    OptionGroup group = group_of(app, title);
    if (!title.empty() && !group.options.empty()) table.groups.push_back(std::move(group));
  }
  const auto formatter = app.get_formatter();
  if (const auto* help = dynamic_cast<const HelpFormatter*>(formatter.get())) table.text = help->text();
  for (const std::string& name : table.text.required_arguments)
    for (OptionRow& argument : table.arguments)
      if (argument.name == name) argument.is_required = true;
  for (const CLI::App* command : app.get_subcommands({}))
    table.commands.push_back(table_of(*command, full_name + " " + command->get_name()));
  return table;
}

std::vector<VariableRow> variables_of(const CommandTable& table) {
  std::vector<VariableRow> rows;
  std::optional<VariableRow> by_rule;
  for (const OptionGroup& group : table.groups)
    for (const OptionRow& option : group.options) {
      if (option.variable.empty()) continue;
      const VariableRow row{option.variable, "Default of " + option.name};
      if (option.variable != variable_of(table.full_name, option.name))
        rows.push_back(row);
      else if (!by_rule)
        by_rule = VariableRow{row.name, row.description + ", and so on for each other option"};
    }
  if (by_rule) rows.push_back(*by_rule);
  return rows;
}

std::string usage_of(const CommandTable& table) {
  if (!table.commands.empty()) return table.full_name + " COMMAND [OPTIONS]";
  std::string line = table.full_name + " [OPTIONS]";
  for (const OptionGroup& group : table.groups)
    for (const OptionRow& option : group.options)
      if (option.is_required) line += fmt::format(" {} {}", option.name, option.value);
  for (const OptionRow& argument : table.arguments)
    line += argument.is_required ? " " + argument.name : " [" + argument.name + "]";
  return line;
}

}  // namespace tessera::cli
