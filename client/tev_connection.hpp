// SPDX-License-Identifier: Apache-2.0
// A connection to tev, an image viewer. Not thread-safe.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "core/base/error.hpp"
#include "core/base/open_file.hpp"

namespace tessera::client {

inline constexpr std::string_view kDefaultTev = "127.0.0.1:14158";  // where tev listens by itself
// How long to wait until tev is looked for again.
inline constexpr double kTevRetrySeconds = 2;

// Adds --tev with or without HOST:PORT. `address` is set if it is given.
void add_tev_option(CLI::App& command, std::optional<std::string>& address);

// A value of --tev that is none: the argument behind an option without value looks like its value. Empty if
// there is none; else `address` becomes the default.
std::string take_argument(std::optional<std::string>& address);

class TevConnection {
 public:
  // Blocks for a few seconds at most. The error says how tev is started.
  static core::Result<TevConnection> open(const std::string& address);

  // Sends a packet of tev_packets.hpp. Blocks until tev takes it, for some seconds at most; after an error,
  // nothing more can be sent.
  core::Status send(std::string_view packet);

 private:
  TevConnection(core::OpenFile socket, std::string address)
      : socket_(std::move(socket)), address_(std::move(address)) {}

  core::OpenFile socket_;
  std::string address_;
};

}  // namespace tessera::client
