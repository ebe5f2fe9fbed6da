// SPDX-License-Identifier: Apache-2.0
// What tessera-coordinator can be told, in one place: flags, --help and defaults come from here.
#pragma once

#include <filesystem>
#include <string>

#include "core/base/determinism_fingerprint.hpp"
#include "proto/channel.hpp"
#include "server/limits.hpp"
#include "server/store/state_directory.hpp"
#include "server/validator/validator_process.hpp"

namespace tessera::server {

struct Options {
  // HOST:PORT to serve at. Port 0 picks a free one.
  std::string listen = proto::kDefaultCoordinator;
  // Folder for what must survive: jobs, films, scenes.
  std::filesystem::path state = store::default_state_directory();
  // A worker silent for so long loses its work to others. Shorter: less delay when one dies; less patience
  // with the network.
  double lease_seconds = 10;
  // Scenes' files that no job names are removed after so many hours.
  double keep_unused_hours = 24;
  // The share of ranges that another worker renders again, to find out who computes other bits. 1: everything
  // is rendered twice.
  double audit = 0;
  // The determinism fingerprint of the workers that may join.
  std::string fingerprint{core::kDeterminismFingerprint};
  proto::ServerSecurity security;
  // File with the tokens of those who may call; see rpc::Access. Empty: everybody may do everything.
  std::string tokens;
  // Instead of running: a state folder to look at, or to mend.
  std::filesystem::path check, salvage;
  // The tessera-validator to start for submitted scenes.
  std::string validator = validator::default_validator_path();
  Limits limits;
};

// Reads the command line. On --help, --version and mistakes it prints what there is to say and ends the
// process.
Options parse_options(int argc, char** argv);

}  // namespace tessera::server
