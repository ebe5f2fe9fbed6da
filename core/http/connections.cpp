// SPDX-License-Identifier: Apache-2.0
#include "core/http/connections.hpp"

#include <algorithm>

namespace tessera::http {

void Connections::add(const std::shared_ptr<Connection>& connection) {
  const std::lock_guard lock(mutex_);
  if (is_stopping_) connection->stop();
  if (is_disconnecting_) connection->disconnect();
  all_.insert(connection);
}

void Connections::remove(const std::shared_ptr<Connection>& connection) {
  const std::lock_guard lock(mutex_);
  all_.erase(connection);
}

bool Connections::accepts(std::size_t max_connections) const {
  const std::lock_guard lock(mutex_);
  return !is_stopping_ && all_.size() < max_connections;
}

void Connections::stop() {
  const std::lock_guard lock(mutex_);
  is_stopping_ = true;
  for (const auto& connection : all_) connection->stop();
}

template <typename Condition>
void Connections::await(Condition is_true, std::chrono::milliseconds longest) {
  // Notifications come without the mutex, so that one can be missed.
  constexpr std::chrono::milliseconds kStep{20};
  const auto end = std::chrono::steady_clock::now() + longest;
  std::unique_lock lock(mutex_);
  while (!is_true() && std::chrono::steady_clock::now() < end) changed_.wait_for(lock, kStep);
}

void Connections::await_answers(std::chrono::milliseconds longest) {
  await(
      [&] {
        return std::none_of(all_.begin(), all_.end(), [](const auto& one) { return one->is_answering(); });
      },
      longest);
}

void Connections::disconnect(std::chrono::milliseconds longest) {
  {
    const std::lock_guard lock(mutex_);
    is_disconnecting_ = true;
    for (const auto& connection : all_) connection->disconnect();
  }
  await([&] { return all_.empty(); }, longest);
}

}  // namespace tessera::http
