// SPDX-License-Identifier: Apache-2.0
#include "core/cli/parse.hpp"

#include <unistd.h>

#include <cstdio>
#include <string_view>

#include "core/base/printable.hpp"
#include "core/base/standard_streams.hpp"

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
  write(stderr,
        program + ": error: " + core::printable_lines(what) + "\nTry: " + called(app, program) + "--help\n");
  return kExitUsage;
}

// The error message if a program requires a command and none was called; otherwise empty. CLI11 takes
// --help after an unknown word for a request for help.
std::string no_command(const CLI::App& app, bool asks_for_help, int argc, char** argv) {
  if (app.get_subcommands({}).empty() || !app.get_subcommands().empty()) return "";
  const std::string first = argc > 1 ? argv[1] : "";
  if (first.empty()) return "a command is missing";
  if (!first.starts_with('-')) return "there is no command '" + first + "'";
  return asks_for_help ? "" : "there is no option '" + first + "' before a command";
}

}  // namespace

std::optional<int> parse(CLI::App& app, int argc, char** argv, const std::string& program) {
  try {
    app.parse(argc, argv);
    return std::nullopt;
  } catch (const CLI::ParseError& end) {
    const std::string what = no_command(app, end.get_exit_code() == 0, argc, argv);
    if (!what.empty()) return refuse(app, program, what);
    if (end.get_exit_code() != 0) return refuse(app, program, end.what());
    // CLI11 provides help and version texts in different ways.
    const bool version = dynamic_cast<const CLI::CallForVersion*>(&end) != nullptr;
    write(stdout, version ? std::string(end.what()) + "\n" : app.help());
    return flush_stdout(kExitOk, program);
  }
}

int flush_stdout(int exit_code, const std::string& program) {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return exit_code;
  if (core::reader_is_gone(STDOUT_FILENO)) return exit_code;
  write(stderr,
        program +
            ": error: stdout cannot be written, so results are missing: is the disk full that it goes to?\n");
  return exit_code == kExitOk ? kExitFailed : exit_code;
}

}  // namespace tessera::cli
