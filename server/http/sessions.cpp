// SPDX-License-Identifier: Apache-2.0
#include "server/http/sessions.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <iterator>
#include <sstream>
#include <utility>

#include "core/image/file_io.hpp"
#include "server/auth/credentials.hpp"
#include "server/base/random.hpp"

namespace tessera::http_api {
namespace {

std::chrono::seconds since_epoch(Sessions::Clock::time_point time) {
  return std::chrono::duration_cast<std::chrono::seconds>(time.time_since_epoch());
}

}  // namespace

// The file has a line for each session: its key, the digest of its token, and when it ends.
Sessions::Sessions(std::filesystem::path file, std::function<Clock::time_point()> now)
    : file_(std::move(file)), now_(std::move(now)) {
  if (file_.empty() || !std::filesystem::exists(file_)) return;
  const core::MutexLock lock(mutex_);
  const auto bytes = core::read_file(file_.string());
  if (!bytes) {
    spdlog::warn("the sessions of the page have ended: {}", bytes.error().message);
    return;
  }
  const std::int64_t now_s = since_epoch(now_()).count(), latest_s = since_epoch(now_() + kLifetime).count();
  std::istringstream lines(*bytes);
  Session session;
  for (std::int64_t ends_s = 0;
       sessions_.size() < kMax && lines >> session.key >> session.token_digest >> ends_s;)
    if (ends_s > now_s && ends_s <= latest_s)
      add({session.key, session.token_digest, Clock::time_point(std::chrono::seconds(ends_s))});
}

std::string Sessions::open(const std::string& token_digest) {
  const std::string id = base::random_id() + base::random_id();
  const core::MutexLock lock(mutex_);
  forget_ended();
  const auto is_of_token = [&](const Session& session) { return session.token_digest == token_digest; };
  const auto of_token = std::count_if(sessions_.begin(), sessions_.end(), is_of_token);
  if (static_cast<std::size_t>(of_token) >= kMaxOfToken)
    forget(std::find_if(sessions_.begin(), sessions_.end(), is_of_token));
  if (sessions_.size() >= kMax) forget(sessions_.begin());
  add({auth::digest_of_token(id), token_digest, now_() + kLifetime});
  write();
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
  const auto found = by_key_.find(key);
  if (found == by_key_.end()) return;
  forget(found->second);
  write();
}

std::size_t Sessions::count() const {
  const core::MutexLock lock(mutex_);
  return sessions_.size();
}

void Sessions::add(Session session) {
  sessions_.push_back(std::move(session));
  by_key_[sessions_.back().key] = std::prev(sessions_.end());
}

void Sessions::write() const {
  if (file_.empty()) return;
  std::string lines;
  for (const Session& session : sessions_)
    fmt::format_to(std::back_inserter(lines), "{} {} {}\n", session.key, session.token_digest,
                   since_epoch(session.ends).count());
  if (auto written = core::write_file_atomically(file_.string(), lines); !written)
    spdlog::warn("the sessions of the page end with this coordinator: {}", written.error().message);
}

void Sessions::forget(Order::iterator session) {
  by_key_.erase(session->key);
  sessions_.erase(session);
}

void Sessions::forget_ended() {
  while (!sessions_.empty() && sessions_.front().ends <= now_()) forget(sessions_.begin());
}

}  // namespace tessera::http_api
