// SPDX-License-Identifier: Apache-2.0
#include "server/http/sessions.hpp"

#include <algorithm>

#include "server/auth/credentials.hpp"
#include "server/base/random.hpp"

namespace tessera::http_api {

std::string Sessions::open(const std::string& token_digest) {
  const std::string id = base::random_id() + base::random_id();
  const core::MutexLock lock(mutex_);
  forget_ended();
  const auto is_of_token = [&](const Session& session) { return session.token_digest == token_digest; };
  const auto of_token = std::count_if(sessions_.begin(), sessions_.end(), is_of_token);
  if (static_cast<std::size_t>(of_token) >= kMaxOfToken)
    forget(std::find_if(sessions_.begin(), sessions_.end(), is_of_token));
  if (sessions_.size() >= kMax) forget(sessions_.begin());
  sessions_.push_back({auth::digest_of_token(id), token_digest, now_() + kLifetime});
  by_key_[sessions_.back().key] = std::prev(sessions_.end());
  return id;
}

std::optional<std::string> Sessions::token_digest(const std::string& id) {
  if (id.empty()) return std::nullopt;
  const std::string key = auth::digest_of_token(id);
  const core::MutexLock lock(mutex_);
  forget_ended();
  const auto found = by_key_.find(key);
  return found == by_key_.end() ? std::nullopt : std::optional(found->second->token_digest);
}

void Sessions::close(const std::string& id) {
  const std::string key = auth::digest_of_token(id);
  const core::MutexLock lock(mutex_);
  if (const auto found = by_key_.find(key); found != by_key_.end()) forget(found->second);
}

std::size_t Sessions::count() const {
  const core::MutexLock lock(mutex_);
  return sessions_.size();
}

void Sessions::forget(Order::iterator session) {
  by_key_.erase(session->key);
  sessions_.erase(session);
}

void Sessions::forget_ended() {
  while (!sessions_.empty() && sessions_.front().ends <= now_()) forget(sessions_.begin());
}

}  // namespace tessera::http_api
