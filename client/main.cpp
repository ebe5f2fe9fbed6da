// tessera: the command line. Hands over to the command that was called and reports its exit status.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "client/commands.hpp"
#include "client/console.hpp"
#ifdef TESSERA_FARM
#include "client/farm/farm_commands.hpp"
#endif
#include "core/base/version.hpp"

namespace tessera::client {
namespace {

constexpr const char* kFooter = R"(Each command explains itself: tessera render --help
Exit status: 0 done, 1 failed, 2 wrong command line, 130 interrupted.)";

// What CLI11 throws for --help and --version counts as success and prints itself, unless a word before it was
// meant as a command.
int end_parsing(const CLI::App& app, const CLI::ParseError& end, const std::string& first_word) {
  const auto called = app.get_subcommands();
  const std::string command = called.empty() ? "" : called.front()->get_name() + " ";
  const bool misspelt = called.empty() && !first_word.empty();
  if (end.get_exit_code() == 0 && !(misspelt && first_word.front() != '-')) return app.exit(end);
  print_error(misspelt ? "there is no command '" + first_word + "'" : end.what());
  print_hint("tessera " + command + "--help");
  return kExitUsage;
}

// Also of a command whose results did not get to where they were sent.
int with_results_written(int exit_code) {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return exit_code;
  print_error("stdout cannot be written, so results are missing: is the disk full that it goes to?");
  return exit_code == kExitOk ? kExitFailed : exit_code;
}

int run(int argc, char** argv) {
  CLI::App app{"Tessera renders pictures by path tracing, on one machine or on many.", "tessera"};
  app.set_version_flag("--version", "tessera " + std::string(core::version()));
  app.footer(kFooter);
  app.require_subcommand(1);
  int exit_code = kExitOk;
  add_render_command(app, exit_code);
  add_compare_command(app, exit_code);
#ifdef TESSERA_FARM
  add_farm_commands(app, exit_code);
#endif
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& end) {
    return end_parsing(app, end, argc > 1 ? argv[1] : "");
  }
  return with_results_written(exit_code);
}

}  // namespace
}  // namespace tessera::client

int main(int argc, char** argv) {
  // Errors are told once, in our words; GRPC_VERBOSITY=DEBUG brings gRPC's own back.
  setenv("GRPC_VERBOSITY", "NONE", 0);
  try {
    return tessera::client::run(argc, argv);
  } catch (const std::bad_alloc&) {
    return tessera::client::print_error("not enough memory");
  } catch (const std::exception& e) {
    return tessera::client::print_error(e.what());
  }
}
