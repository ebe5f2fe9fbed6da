// SPDX-License-Identifier: Apache-2.0
#include "client/commands.hpp"
#include "client/console.hpp"
#include "client/scene_schema.hpp"
#include "core/cli/help.hpp"

namespace tessera::client {

void add_schema_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("schema", "Print the JSON Schema of scene files");
  cli::set_help(*command,
                {.notes = R"(Editors that know JSON Schema complete keys, show their descriptions and mark
mistakes while you type. Save the schema beside your scene file and name it there:
  "$schema": "scene.schema.json")",
                 .exit_statuses = kUsualExitStatuses,
                 .examples = {"tessera schema > scene.schema.json"}});
  command->callback([&exit_code] {
    print_result(scene_schema());
    exit_code = kExitOk;
  });
}

}  // namespace tessera::client
