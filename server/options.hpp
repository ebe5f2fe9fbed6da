// SPDX-License-Identifier: Apache-2.0
// The options of tessera-coordinator: flags, --help and defaults come from this file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/common/log.hpp"
#include "proto/channel.hpp"
#include "server/limits.hpp"
#include "server/store/state_directory.hpp"
#include "server/validator/validator_process.hpp"

namespace tessera::server {

struct Options {
  // HOST:PORT to listen at. Port 0 picks a free one.
  std::string listen = proto::kDefaultCoordinator;
  // The state directory, which keeps jobs, films and scenes.
  std::filesystem::path state = store::default_state_directory();
  // The heartbeat timeout: a worker that is silent for longer loses its leases. A shorter one means less
  // delay when a worker dies, and less tolerance of a slow network.
  double lease_seconds = 10;
  // Scene files that no job names are removed after so many hours.
  double keep_unused_hours = 24;
  // How many finished jobs are kept, or for how long: see jobs::read_keep_finished(). Empty: for ever.
  std::string keep_finished;
  // The share of ranges that a second worker renders again, to find workers whose bits differ. 1 renders
  // everything twice.
  double audit = 0;
  // The determinism fingerprints that workers may have. Empty: that of this release.
  std::vector<std::string> fingerprints;
  proto::ServerSecurity security;
  // The file with the callers' tokens; see auth::Access. Empty: everybody may call everything.
  std::string tokens;
  // A state directory to check or to salvage, instead of running.
  std::filesystem::path check, salvage;
  // Where to write a backup of `state`, or the backup of which to make `state`, instead of running.
  std::filesystem::path backup, restore;
  // The tessera-validator to start for submitted scenes.
  std::string validator = validator::default_validator_path();
  // Whether to start only if nothing is missing of the validator's sandbox.
  bool require_sandbox = false;
  Limits limits;
  // HOST:PORT of the page and of the HTTP API (server/http/api.hpp), or "off".
  std::string http = "127.0.0.1:7480";
  // Whether that was given: a default port that is taken is no error.
  bool http_is_given = false;
  // A socket of the service manager that listens at `http`; -1 for none.
  int http_socket = -1;
  // HOST:PORT to serve metrics at (proto/metrics_server.hpp). Empty: nowhere.
  std::string metrics;
  // HOST:PORT for cluster managers (server/scaling/cluster_server.hpp). Empty: nowhere.
  std::string cluster;
  common::LogOptions log;
};

// Parses the command line. On --help, --version and errors it prints the text and ends the process.
Options parse_options(int argc, char** argv);

}  // namespace tessera::server
