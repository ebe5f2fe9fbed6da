// SPDX-License-Identifier: Apache-2.0
// A coordinator that runs: its threads, its port, its services, and their end in the right order.
#pragma once

#include <memory>
#include <string>

#include "core/base/error.hpp"
#include "proto/channel.hpp"
#include "proto/security.hpp"
#include "server/coordinator/coordinator.hpp"
#include "server/limits.hpp"
#include "server/rpc/access.hpp"

namespace tessera::rpc {

struct ServerOptions {
  std::string address;  // HOST:PORT to listen at; port 0 picks a free one
  proto::ServerSecurity security{};
  Access access{};
  server::Limits limits{};
  proto::Patience patience{};
};

class Server {
 public:
  // The coordinator must stay until the server is destroyed. Errors: those of proto::server_credentials()
  // and listen_on().
  static core::Result<std::unique_ptr<Server>> start(coordinator::Coordinator& coordinator,
                                                     ServerOptions options);
  // Stops, if that was not done before.
  ~Server();

  // HOST:PORT with the port that was picked.
  const std::string& address() const { return address_; }

  // Answers what waits, ends every call, and writes the last checkpoint. Whether that was written.
  core::Status stop();

 private:
  struct Parts;
  Server(std::unique_ptr<Parts> parts, std::string address);

  std::unique_ptr<Parts> parts_;  // null once stopped
  const std::string address_;
};

}  // namespace tessera::rpc
