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
#include "core/common/rate_limited_log.hpp"
#include "proto/connection_slots.hpp"
#include "proto/listening_sockets.hpp"

namespace tessera::proto {

class Listener {
 public:
  // Takes ownership of a connection's descriptor.
  using Take = std::function<void(int descriptor)>;

  // The ends of the sentences that say why a connection was closed: beyond the limit of all, and of its
  // machine.
  struct Reasons {
    std::string all = "no more are taken";
    std::string machine = "no more of one machine are taken";
  };

  // Connections queue up until start(). UNAVAILABLE if the descriptor that wakes the thread cannot be made.
  static core::Result<std::unique_ptr<Listener>> make(ListeningSockets listening, ConnectionSlots slots,
                                                      Reasons reasons);
  // Calls stop() if it was not called.
  ~Listener();

  int port() const { return port_; }

  // Starts a thread that hands on connections. It closes those beyond the limits at once, and logs them at
  // most once in ten seconds.
  void start(Take take);
  // Closes the listening sockets. Connections that were handed on stay open.
  void stop();

 private:
  Listener(ListeningSockets listening, ConnectionSlots slots, Reasons reasons, core::OpenFile stopped);

  void run(const Take& take);
  // The timeout for poll() in milliseconds; negative for none.
  int wait_ms() const;
  void accept_from(const core::OpenFile& socket, const Take& take);
  bool has_room(const std::string& machine);
  // `machine`: empty if it is unknown.
  void warn(std::string sentence, const std::string& machine);

  const int port_;
  const Reasons reasons_;
  const core::OpenFile stopped_;  // becomes readable when the thread is to stop
  // Used by the thread alone while it runs.
  std::vector<core::OpenFile> sockets_;
  ConnectionSlots slots_;
  common::RateLimitedLog log_;
  std::thread thread_;
};

}  // namespace tessera::proto
