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
  // A response was sent.
  void note_answer() { answered_.notify_all(); }

 private:
  bool are_answering() const;

  mutable std::mutex mutex_;
  std::condition_variable answered_;
  // Guarded by mutex_:
  std::set<std::shared_ptr<Connection>> all_;
  bool is_stopping_ = false;
};

}  // namespace tessera::http
