// A coordinator that runs: its threads, its port, its services, and their end in the right order.
#pragma once

#include <memory>
#include <string>

#include "core/base/error.hpp"
#include "server/coordinator/coordinator.hpp"

namespace tessera::rpc {

class Server {
 public:
  // Listens at HOST:PORT; port 0 picks a free one. The coordinator must stay until the server is destroyed.
  // UNAVAILABLE if the port is taken.
  static core::Result<std::unique_ptr<Server>> start(coordinator::Coordinator& coordinator,
                                                     const std::string& address);
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
