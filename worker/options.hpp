// SPDX-License-Identifier: Apache-2.0
// The command line of tessera-worker.
#pragma once

#include <string>

#include "core/common/log.hpp"
#include "proto/channel.hpp"
#include "worker/confined_loader.hpp"

namespace tessera::worker {

struct Options {
  std::string coordinator = proto::kDefaultCoordinator;  // HOST:PORT
  unsigned threads;                                      // to render with; default: all of this machine
  std::string cache;                                     // folder for scene files; may be shared by workers
  double cache_gib = 16;                                 // limit; scene files are removed, oldest first
  std::string name;                                      // for people; default: the host's
  proto::ClientSecurity security;
  common::LogOptions log;
  std::string metrics;      // HOST:PORT to serve metrics at; empty: nowhere
  std::string serve_blobs;  // HOST:PORT to serve files to other workers at; empty: nowhere
  LoaderOptions loader;

  Options();
  std::uint64_t cache_bytes() const { return static_cast<std::uint64_t>(cache_gib * (1 << 30)); }
};

// Parses the command line. On --help, --version and errors it prints the text and ends the process.
Options parse_options(int argc, char** argv);

}  // namespace tessera::worker
