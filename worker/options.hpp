// SPDX-License-Identifier: Apache-2.0
// The command line of tessera-worker.
#pragma once

#include <string>

#include "proto/channel.hpp"

namespace tessera::worker {

struct Options {
  std::string coordinator = proto::kDefaultCoordinator;  // HOST:PORT
  unsigned threads;                                      // to render with; all of this machine's by default
  std::string cache;                                     // folder for scenes' files; may be shared by workers
  double cache_gib = 16;  // scenes' files beyond this are removed, oldest first
  std::string name;       // for people; the host's by default
  proto::ClientSecurity security;
  bool verbose = false;

  Options();
  std::uint64_t cache_bytes() const { return static_cast<std::uint64_t>(cache_gib * (1 << 30)); }
};

// Reads the command line. On --help, --version and mistakes it prints what there is to say and ends the
// process.
Options parse_options(int argc, char** argv);

}  // namespace tessera::worker
