// SPDX-License-Identifier: Apache-2.0
#include "core/cli/help.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <sstream>
#include <string_view>

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

class Formatter : public CLI::Formatter {
 public:
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode) const override {
    const std::size_t columns = columns_of_stdout();
    std::string help =
        wrap_all(app->get_description(), columns) + '\n' + usage(app, name) + commands(app, columns);
    help += section("Arguments", app->get_options(is_argument), columns);
    for (const std::string& group : app->get_groups()) {
      auto options = app->get_options(
          [&](const CLI::Option* option) { return !is_argument(option) && option->get_group() == group; });
      std::stable_partition(options.begin(), options.end(), [&](const CLI::Option* option) {
        return option != app->get_help_ptr() && option != app->get_version_ptr();
      });
      help += section(group, options, columns);
    }
    help += environment(app, columns);
    if (!app->get_footer().empty()) help += '\n' + wrap_all(app->get_footer(), columns);
    return help;
  }

 private:
  using Options = std::vector<const CLI::Option*>;

  static bool is_argument(const CLI::Option* option) { return option->get_positional(); }

  // The placeholder of the value: "FILE".
  static std::string value_name(const CLI::Option* option) {
    if (!option->get_option_text().empty()) return option->get_option_text();
    return option->get_items_expected_max() == 0 ? "" : option->get_type_name();
  }

  // "-o, --output FILE"
  static std::string left_column(const CLI::Option* option) {
    if (is_argument(option)) return option->get_name(true);
    const std::string shorts =
        option->get_snames().empty() ? "    " : "-" + option->get_snames().front() + ", ";
    const std::string value = value_name(option);
    return shorts + "--" + option->get_lnames().front() + (value.empty() ? "" : " " + value);
  }

  static std::string right_column(const CLI::Option* option) {
    const std::string value = option->get_default_str();
    return option->get_description() + (value.empty() ? "" : fmt::format(" [default: {}]", value));
  }

  static std::string section(const std::string& title, const Options& options, std::size_t columns) {
    if (options.empty() || title.empty()) return "";
    std::string text = '\n' + title + ":\n";
    for (const CLI::Option* option : options)
      text += two_columns(left_column(option), right_column(option), columns);
    return text;
  }

  static std::string usage(const CLI::App* app, const std::string& name) {
    std::string line = "Usage: " + (name.empty() ? app->get_name() : name);
    if (!app->get_subcommands({}).empty()) return line + " COMMAND [OPTIONS]\n";
    line += " [OPTIONS]";
    for (const CLI::Option* option : app->get_options()) {
      if (option->get_required() && !is_argument(option))
        line += fmt::format(" --{} {}", option->get_lnames().front(), value_name(option));
    }
    for (const CLI::Option* option : app->get_options(is_argument)) line += " " + option->get_name(true);
    return line + '\n';
  }

  static std::string commands(const CLI::App* app, std::size_t columns) {
    std::string text, group;
    for (const CLI::App* command : app->get_subcommands({})) {
      if (command->get_group() != group) text += '\n' + command->get_group() + ":\n";
      group = command->get_group();
      text += two_columns(command->get_name(), command->get_description(), columns);
    }
    return text;
  }

  static std::string environment(const CLI::App* app, std::size_t columns) {
    std::string text;
    for (const CLI::Option* option : app->get_options()) {
      if (!option->get_envname().empty())
        text += two_columns(option->get_envname(), "Default of --" + option->get_lnames().front(), columns);
    }
    return text.empty() ? "" : "\nEnvironment variables:\n" + text;
  }
};

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

void set_help(CLI::App& app, const HelpText& text) {
  app.formatter(std::make_shared<Formatter>());
  app.set_help_flag("-h,--help", "Print this help");
  app.footer(footer_of(text));
}

CLI::Validator existing_file() {
  return without_words(CLI::ExistingFile);
}

CLI::Validator existing_folder() {
  return without_words(CLI::ExistingDirectory);
}

}  // namespace tessera::cli
