// SPDX-License-Identifier: Apache-2.0
// Accepts connections up to a limit and hands them to gRPC. gRPC 1.51 accepts any number of them, and stops
// listening for good when the process runs out of file descriptors.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "core/base/error.hpp"
#include "server/base/rate_limited_log.hpp"
#include "server/rpc/connection_slots.hpp"
#include "server/rpc/listening_sockets.hpp"

namespace tessera::rpc {

class Listener {
 public:
  // Takes ownership of a connection's descriptor.
  using Take = std::function<void(int descriptor)>;

  // Connections queue up until start(). UNAVAILABLE if the descriptor that wakes the thread cannot be made.
  static core::Result<std::unique_ptr<Listener>> make(ListeningSockets listening, ConnectionSlots slots);
  // Calls stop() if it was not called.
  ~Listener();

  int port() const { return port_; }

  // Starts a thread that hands on connections. It closes those beyond the limits at once, and logs them at
  // most once in ten seconds.
  void start(Take take);
  // Closes the listening sockets. Connections that were handed on stay open.
  void stop();

 private:
  Listener(ListeningSockets listening, ConnectionSlots slots, base::Fd stopped);

  void run(const Take& take);
  // The timeout for poll() in milliseconds; negative for none.
  int wait_ms() const;
  void accept_from(const base::Fd& socket, const Take& take);
  bool has_room(const std::string& machine);
  // `machine`: empty if it is unknown.
  void warn(std::string sentence, const std::string& machine);

  const int port_;
  const base::Fd stopped_;  // becomes readable when the thread is to stop
  // Used by the thread alone while it runs.
  std::vector<base::Fd> sockets_;
  ConnectionSlots slots_;
  base::RateLimitedLog log_;
  std::thread thread_;
};

}  // namespace tessera::rpc
