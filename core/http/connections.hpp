// SPDX-License-Identifier: Apache-2.0
// The open connections of a server. Thread-safe.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <memory>
#include <mutex>
#include <set>

#include "core/http/connection.hpp"

namespace tessera::http {

class Connections {
 public:
  void add(const std::shared_ptr<Connection>& connection);
  void remove(const std::shared_ptr<Connection>& connection);
  // Whether there may be one more, of so many.
  bool accepts(std::size_t max_connections) const;

  // Ends bodies that are produced over time, also those of later requests, and accepts no more connections.
  void stop();
  // Blocks until all other responses are sent, for so long at most.
  void await_answers(std::chrono::milliseconds longest);
  // After stop(): disconnects all, and blocks until they are removed, for so long at most.
  void disconnect(std::chrono::milliseconds longest);
  // A response was sent, or a connection removed.
  void note_change() { changed_.notify_all(); }

 private:
  // Blocks until is_true(), with the mutex.
  template <typename Condition>
  void await(Condition is_true, std::chrono::milliseconds longest);

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  // Guarded by mutex_:
  std::set<std::shared_ptr<Connection>> all_;
  bool is_stopping_ = false;
  bool is_disconnecting_ = false;
};

}  // namespace tessera::http
