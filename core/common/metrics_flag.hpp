// SPDX-License-Identifier: Apache-2.0
// The command-line option for metrics, shared by coordinator and worker.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace tessera::common {

// Adds --metrics. `address` must live until the command line is parsed, which fills it in; empty: none are
// served.
inline void add_metrics_flag(CLI::App& command, std::string& address) {
  command
      .add_option(
          "--metrics", address,
          "Serve metrics for Prometheus over HTTP at this address, an IP address or localhost; port 0 "
          "picks a free port. Without credentials: name an address that only this machine or a "
          "trusted network reaches")
      ->type_name("HOST:PORT");
}

}  // namespace tessera::common
