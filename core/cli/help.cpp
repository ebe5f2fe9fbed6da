// SPDX-License-Identifier: Apache-2.0
#include "core/cli/help.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <sstream>
#include <string_view>

#include "core/cli/help_formatter.hpp"
#include "core/cli/option_table.hpp"

namespace tessera::cli {
namespace {

constexpr std::size_t kDefaultColumns = 80, kFewestColumns = 60, kMaxColumns = 120;
constexpr std::size_t kIndent = 2, kDescriptionColumn = 28;

std::size_t columns_of_stdout() {
  winsize size{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return kDefaultColumns;
  return std::clamp<std::size_t>(size.ws_col, kFewestColumns, kMaxColumns);
}

// Wraps a paragraph at `columns`. The first line begins at column `at`; the others are indented by `indent`
// spaces.
std::string wrap(std::string_view paragraph, std::size_t columns, std::size_t indent, std::size_t at) {
  std::string text;
  std::istringstream words{std::string(paragraph)};
  bool line_is_empty = true;
  for (std::string word; words >> word; line_is_empty = false) {
    if (!line_is_empty && at + 1 + word.size() > columns) {
      text += '\n' + std::string(indent, ' ');
      at = indent;
      line_is_empty = true;
    }
    text += (line_is_empty ? "" : " ") + word;
    at += word.size() + (line_is_empty ? 0 : 1);
  }
  return text;
}

std::string two_columns(const std::string& left, const std::string& right, std::size_t columns) {
  std::string text = std::string(kIndent, ' ') + left;
  if (right.empty()) return text + '\n';
  if (text.size() + kIndent > kDescriptionColumn) text += '\n' + std::string(kDescriptionColumn, ' ');
  const std::size_t line_begin = text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1;
  text.resize(std::max(text.size(), line_begin + kDescriptionColumn), ' ');
  return text + wrap(right, columns, kDescriptionColumn, kDescriptionColumn) + '\n';
}

// Wraps paragraphs; lines that begin with a space stay as they are.
std::string wrap_all(const std::string& text, std::size_t columns) {
  std::string wrapped, paragraph;
  const auto end_paragraph = [&] {
    if (!paragraph.empty()) wrapped += wrap(paragraph, columns, 0, 0) + '\n';
    paragraph.clear();
  };
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty() && line.front() != ' ') {
      paragraph += line + ' ';
      continue;
    }
    end_paragraph();
    wrapped += line + '\n';
  }
  end_paragraph();
  return wrapped;
}

// "-o, --output FILE"
std::string left_column(const OptionRow& option) {
  const std::string shorts = option.short_name.empty() ? "    " : option.short_name + ", ";
  return shorts + option.name + (option.value.empty() ? "" : " " + option.value);
}

std::string arguments(const CommandTable& table, std::size_t columns) {
  if (table.arguments.empty()) return "";
  std::string text = "\nArguments:\n";
  for (const OptionRow& argument : table.arguments)
    text += two_columns(argument.name, argument.description, columns);
  return text;
}

std::string options(const CommandTable& table, std::size_t columns) {
  std::string text;
  for (const OptionGroup& group : table.groups) {
    text += '\n' + group.title + ":\n";
    for (const OptionRow& option : group.options)
      text += two_columns(left_column(option), option.description, columns);
  }
  return text;
}

std::string commands(const CommandTable& table, std::size_t columns) {
  std::string text, group;
  for (const CommandTable& command : table.commands) {
    if (command.group != group) text += '\n' + command.group + ":\n";
    group = command.group;
    text += two_columns(command.name, command.description, columns);
  }
  return text;
}

std::string environment(const CommandTable& table, std::size_t columns) {
  std::string text;
  for (const VariableRow& variable : variables_of(table))
    text += two_columns(variable.name, variable.description, columns);
  return text.empty() ? "" : "\nEnvironment variables:\n" + text;
}

std::string footer_of(const HelpText& text) {
  std::string footer = text.notes.empty() ? "" : text.notes + '\n';
  const auto begin = [&](const char* title) {
    footer += fmt::format("{}{}:\n", footer.empty() ? "" : "\n", title);
  };
  if (!text.exit_statuses.empty()) begin("Exit status");
  for (const auto& [status, meaning] : text.exit_statuses)
    footer += fmt::format("  {:<4}{}\n", status, meaning);
  if (!text.examples.empty()) begin("Examples");
  for (const std::string& example : text.examples) footer += fmt::format("  {}\n", example);
  return footer;
}

CLI::Validator without_words(CLI::Validator validator) {
  return validator.description("");
}

}  // namespace

std::string HelpFormatter::make_help(const CLI::App* app, std::string name, CLI::AppFormatMode) const {
  const std::size_t columns = columns_of_stdout();
  const CommandTable table = table_of(*app, name.empty() ? app->get_name() : name);
  const std::string footer = footer_of(table.text);
  return wrap_all(table.description, columns) + "\nUsage: " + usage_of(table) + '\n' +
         commands(table, columns) + arguments(table, columns) + options(table, columns) +
         environment(table, columns) + (footer.empty() ? "" : '\n' + wrap_all(footer, columns));
}

void set_help(CLI::App& app, const HelpText& text) {
  app.formatter(std::make_shared<HelpFormatter>(text));
  app.set_help_flag("-h,--help", "Print this help");
}

CLI::Validator existing_file() {
  return without_words(CLI::ExistingFile);
}

CLI::Validator existing_folder() {
  return without_words(CLI::ExistingDirectory);
}

}  // namespace tessera::cli
