// SPDX-License-Identifier: Apache-2.0
// tessera: the command line. Hands over to the command that was called and reports its exit status.
#include <CLI/CLI.hpp>
#include <exception>
#include <new>
#include <string>

#include "client/commands.hpp"
#include "client/console.hpp"
#include "client/screen/view_command.hpp"
#include "core/base/standard_streams.hpp"
#ifdef TESSERA_FARM
#include "client/demo/demo_command.hpp"
#include "client/farm/farm_commands.hpp"
#include "proto/channel.hpp"
#endif
#include "core/base/version.hpp"

namespace tessera::client {
namespace {

const cli::HelpText kHelp{.notes = "Run 'tessera help COMMAND' for the options of a command.",
                          .exit_statuses = {{kExitOk, "done"},
                                            {kExitFailed, "failed"},
                                            {kExitUsage, "wrong command line"},
                                            {kExitInterrupted, "interrupted"}},
                          .examples = {"tessera render scene.json -o image.png"}};

// Puts the commands that were added since the last call under a heading of their own.
void group_commands(CLI::App& app, const std::string& heading) {
  const std::string none = CLI::App().get_group();
  for (CLI::App* command : app.get_subcommands([&](CLI::App* added) { return added->get_group() == none; }))
    command->group(heading);
}

int run(int argc, char** argv) {
  CLI::App app{"Render images by path tracing, on this machine or on a render farm", "tessera"};
  cli::set_help(app, kHelp);
  app.set_version_flag("--version", "tessera " + std::string(core::version()), "Print the version");
  app.require_subcommand(1);
  int exit_code = kExitOk;
  add_render_command(app, exit_code);
  add_rerender_command(app, exit_code);
  add_import_command(app, exit_code);
  add_info_command(app, exit_code);
  add_compare_command(app, exit_code);
  add_schema_command(app, exit_code);
#ifndef TESSERA_FARM
  add_view_command(app, exit_code);
#endif
  cli::add_help_command(app);
  group_commands(app, "Commands");
#ifdef TESSERA_FARM
  add_farm_commands(app, exit_code);
  add_demo_command(app, exit_code);
  group_commands(app, "Farm commands");
#endif
  if (const auto ended = cli::parse(app, argc, argv, "tessera")) return *ended;
  return cli::flush_stdout(exit_code, "tessera");
}

}  // namespace
}  // namespace tessera::client

int main(int argc, char** argv) {
  tessera::core::prepare_standard_streams();
#ifdef TESSERA_FARM
  tessera::proto::configure_grpc();
#endif
  try {
    return tessera::client::run(argc, argv);
  } catch (const std::bad_alloc&) {
    return tessera::client::print_error(
        "not enough memory: choose a smaller --size, parts of the image with --crop, or fewer --threads");
  } catch (const std::exception& e) {
    return tessera::client::print_error(e.what());
  }
}
