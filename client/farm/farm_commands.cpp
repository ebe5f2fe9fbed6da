// SPDX-License-Identifier: Apache-2.0
#include "client/farm/farm_commands.hpp"

#include "client/farm/single_commands.hpp"

namespace tessera::client {

void add_farm_commands(CLI::App& app, int& exit_code) {
  add_submit_command(app, exit_code);
  add_list_commands(app, exit_code);
  add_watch_command(app, exit_code);
  add_image_command(app, exit_code);
  add_job_view_command(app, exit_code);
  add_change_commands(app, exit_code);
  add_fleet_commands(app, exit_code);
}

}  // namespace tessera::client
