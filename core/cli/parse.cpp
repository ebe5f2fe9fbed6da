// SPDX-License-Identifier: Apache-2.0
#include "core/cli/parse.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string_view>
#include <vector>

#include "core/base/printable.hpp"
#include "core/base/standard_streams.hpp"
#include "core/base/suggestion.hpp"
#include "core/cli/completion.hpp"
#include "core/cli/config_file.hpp"
#include "core/cli/help.hpp"
#include "core/cli/man_page.hpp"
#include "core/cli/option_table.hpp"

namespace tessera::cli {
namespace {

// Write errors are ignored: there is no other stream to report them on.
void write(std::FILE* stream, std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stream);
  std::fflush(stream);
}

// The command that was called: "tessera render ".
std::string called(const CLI::App& app, const std::string& program) {
  const auto commands = app.get_subcommands();
  return program + " " + (commands.empty() ? "" : commands.front()->get_name() + " ");
}

int refuse(const CLI::App& app, const std::string& program, const std::string& what) {
  print_error(program, what);
  write(stderr, "Try: " + called(app, program) + "--help\n");
  return kExitUsage;
}

// Null if there is no such command.
const CLI::App* find_command(const CLI::App& app, const std::string& name) {
  for (const CLI::App* command : app.get_subcommands({}))
    if (command->get_name() == name) return command;
  return nullptr;
}

std::string unknown_command(const CLI::App& app, const std::string& name) {
  std::vector<std::string_view> known;
  for (const CLI::App* command : app.get_subcommands({})) known.push_back(command->get_name());
  return "there is no command " + core::in_quotes(name) + core::suggestion(name, known);
}

// The message about words of the command line that nothing takes. Empty if there are none.
std::string unknown_words(const CLI::App& app) {
  const std::vector<std::string> words = app.remaining(true);
  if (words.empty()) return "";
  const auto option =
      std::find_if(words.begin(), words.end(), [](const std::string& word) { return word.starts_with('-'); });
  if (option == words.end()) return "unexpected argument " + core::in_quotes(words.front());
  const auto commands = app.get_subcommands();
  const CLI::App& called = commands.empty() ? app : *commands.front();
  const CommandTable table = table_of(called, called.get_name());
  std::vector<std::string_view> known;
  for (const OptionGroup& group : table.groups)
    for (const OptionRow& row : group.options) known.push_back(row.name);
  const std::string name = option->substr(0, option->find('='));
  return "there is no option " + core::in_quotes(name) + core::suggestion(name, known);
}

// What PROGRAM --print-man-page and PROGRAM --print-completion SHELL print. The build calls them.
std::optional<std::string> generated(const CLI::App& app, int argc, char** argv, const std::string& program) {
  const std::string what = argc > 1 ? argv[1] : "";
  if (what == "--print-man-page" && argc == 2) return man_page(table_of(app, program), app.version());
  if (what == "--print-completion" && argc == 3) return completion(table_of(app, program), argv[2]);
  return std::nullopt;
}

// The error message if a program requires a command and none was called; otherwise empty. CLI11 takes
// --help after an unknown word for a request for help.
std::string no_command(const CLI::App& app, bool asks_for_help, int argc, char** argv) {
  if (app.get_subcommands({}).empty() || !app.get_subcommands().empty()) return "";
  const std::string first = argc > 1 ? argv[1] : "";
  if (first.empty()) return "a command is missing";
  if (!first.starts_with('-')) return unknown_command(app, first);
  return asks_for_help ? "" : "there is no option '" + first + "' before a command";
}

}  // namespace

std::optional<int> parse(CLI::App& app, int argc, char** argv, const std::string& program) {
  add_environment_variables(app);
  if (const auto text = generated(app, argc, argv, program)) {
    write(stdout, *text);
    return flush_stdout(kExitOk, program);
  }
  try {
    app.parse(argc, argv);
    return std::nullopt;
  } catch (const CLI::ParseError& end) {
    const std::string what = no_command(app, end.get_exit_code() == 0, argc, argv);
    if (!what.empty()) return refuse(app, program, what);
    if (dynamic_cast<const CLI::ExtrasError*>(&end) != nullptr) {
      const std::string unknown = unknown_words(app);
      return refuse(app, program, unknown.empty() ? end.what() : unknown);
    }
    if (end.get_exit_code() != 0) return refuse(app, program, end.what());
    // CLI11 provides help and version texts in different ways.
    const bool version = dynamic_cast<const CLI::CallForVersion*>(&end) != nullptr;
    write(stdout, version ? std::string(end.what()) + "\n" : app.help());
    return flush_stdout(kExitOk, program);
  }
}

int print_error(std::string_view program, std::string_view message) {
  write(stderr, fmt::format("{}: error: {}\n", program, core::printable_lines(message)));
  return kExitFailed;
}

void add_help_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("help", "Print the help of a command");
  const auto name = std::make_shared<std::string>();
  command->add_option("COMMAND", *name, "Name of the command; without it, the commands are listed");
  set_help(*command, {.exit_statuses = {{kExitOk, "done"}, {kExitUsage, "wrong command line"}},
                      .examples = {app.get_name() + " help", app.get_name() + " help render"}});
  command->callback([&app, name] {
    const CLI::App* asked = name->empty() ? &app : find_command(app, *name);
    if (asked == nullptr) throw CLI::ValidationError(unknown_command(app, *name));
    const std::string full_name = app.get_name() + (name->empty() ? "" : " " + *name);
    write(stdout, asked->get_formatter()->make_help(asked, full_name, CLI::AppFormatMode::Normal));
  });
}

int flush_stdout(int exit_code, const std::string& program) {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return exit_code;
  if (core::reader_is_gone(STDOUT_FILENO)) return exit_code;
  print_error(program, "stdout cannot be written, so results are missing: is the disk full that it goes to?");
  return exit_code == kExitOk ? kExitFailed : exit_code;
}

}  // namespace tessera::cli
