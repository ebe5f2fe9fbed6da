// SPDX-License-Identifier: Apache-2.0
// Accepts connections up to a limit and hands them on. gRPC (1.51) by itself takes any number of them, and
// stops listening for good once the process has no file descriptor left.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "core/base/error.hpp"
#include "server/coordinator/rate_limited_log.hpp"
#include "server/rpc/connection_slots.hpp"
#include "server/rpc/listening_sockets.hpp"

namespace tessera::rpc {

class Listener {
 public:
  // Takes over a connection's descriptor, and closes it some time.
  using Take = std::function<void(int descriptor)>;

  // Connections queue up until start(). UNAVAILABLE if there is nothing to wake its thread with.
  static core::Result<std::unique_ptr<Listener>> make(ListeningSockets listening, ConnectionSlots slots);
  // Stops, if that was not done before.
  ~Listener();

  int port() const { return port_; }

  // Hands on every connection, on a thread of its own. Those beyond the limits are closed at once, and the
  // log says so, at most once in ten seconds.
  void start(Take take);
  // Listens no more. Connections that were handed on stay.
  void stop();

 private:
  Listener(ListeningSockets listening, ConnectionSlots slots, store::Fd stopped);

  void run(const Take& take);
  // For poll(): negative for ever.
  int wait_ms() const;
  void accept_from(const store::Fd& socket, const Take& take);
  bool has_room(const std::string& machine);
  void warn(std::string sentence);

  const int port_;
  const store::Fd stopped_;  // readable once it is to stop
  // Of the thread alone, while there is one.
  std::vector<store::Fd> sockets_;
  ConnectionSlots slots_;
  coordinator::RateLimitedLog log_;
  std::thread thread_;
};

}  // namespace tessera::rpc
