// SPDX-License-Identifier: Apache-2.0
// A running coordinator: its threads, its port, its services, and their shutdown in the right order.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "proto/channel.hpp"
#include "proto/security.hpp"
#include "server/auth/access.hpp"
#include "server/base/file.hpp"
#include "server/coordinator.hpp"
#include "server/jobs/retirement.hpp"
#include "server/limits.hpp"
#include "server/rpc/call_stats.hpp"
#include "server/rpc/services.hpp"

namespace tessera::rpc {

struct ServerOptions {
  std::string address;  // HOST:PORT to listen at; port 0 picks a free one
  // Sockets that listen already, the first of them at `address`. Empty: new ones.
  std::vector<base::Fd> sockets{};
  proto::ServerSecurity security{};
  auth::Access access{};
  server::Limits limits{};
  proto::Patience patience{};
  jobs::KeepFinished keep_finished{};
};

class Server {
 public:
  // The coordinator must outlive the server. Errors are those of proto::server_credentials() and
  // proto::listen_on().
  static core::Result<std::unique_ptr<Server>> start(server::Coordinator& coordinator, ServerOptions options);
  // Calls stop() if it was not called.
  ~Server();

  // HOST:PORT with the actual port.
  const std::string& address() const { return address_; }

  // For another way to call the coordinator, which must end before stop().
  Services services();

  // ---- What it measures; not after stop() ----
  const CallStats& calls() const;
  // The tasks that wait in each thread pool.
  struct QueueDepth {
    const char* pool;
    std::size_t tasks = 0;
  };
  std::vector<QueueDepth> queue_depths() const;
  // See AuthInterceptor::replace_access(). Not after stop().
  void replace_access(auth::Access access);
  // Null without TLS. Not after stop().
  proto::Certificates* certificates();

  // From now on probes are told that it stops.
  void announce_stop();
  // Answers waiting calls, ends all calls, and writes the last checkpoint. Returns whether that was written.
  core::Status stop();

 private:
  struct Parts;
  Server(std::unique_ptr<Parts> parts, std::string address);

  std::unique_ptr<Parts> parts_;  // null after stop()
  const std::string address_;
};

}  // namespace tessera::rpc
