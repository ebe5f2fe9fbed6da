// SPDX-License-Identifier: Apache-2.0
// Sessions of browsers: a random id in a cookie that stands for a token. A session ends after kLifetime and
// with its token, since each call is admitted by what the token may do then. Thread-safe.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <list>
#include <map>
#include <optional>
#include <string>

#include "core/base/mutex.hpp"

namespace tessera::http_api {

class Sessions {
 public:
  using Clock = std::chrono::system_clock;
  static constexpr std::chrono::hours kLifetime{12};
  // Of all tokens, and of one. The oldest gives way.
  static constexpr std::size_t kMax = 10'000, kMaxOfToken = 64;

  // Sessions outlive the process in this file, from which neither their ids nor tokens can be found. If it is
  // empty, they end with the process.
  explicit Sessions(std::filesystem::path file, std::function<Clock::time_point()> now = Clock::now);

  // Returns the id of a new session for the token with this digest (auth::digest_of_token()). Blocks for the
  // disk; if the file cannot be written, that is logged, and the sessions last as long as the process.
  std::string open(const std::string& token_digest);
  // The digest of the token; empty if there is no such session.
  std::optional<std::string> token_digest(const std::string& id);
  void close(const std::string& id);
  std::size_t count() const;

 private:
  struct Session {
    std::string key;  // the SHA-256 of its id, so that neither the file nor look-up times reveal the id
    std::string token_digest;
    Clock::time_point ends;
  };
  using Order = std::list<Session>;
  // ---- The caller holds the lock ----
  void forget(Order::iterator session) TESSERA_REQUIRES(mutex_);
  void forget_ended() TESSERA_REQUIRES(mutex_);
  void add(Session session) TESSERA_REQUIRES(mutex_);
  void write() const TESSERA_REQUIRES(mutex_);

  const std::filesystem::path file_;
  const std::function<Clock::time_point()> now_;
  mutable core::Mutex mutex_;
  Order sessions_ TESSERA_GUARDED_BY(mutex_);  // oldest first
  std::map<std::string, Order::iterator> by_key_ TESSERA_GUARDED_BY(mutex_);
};

}  // namespace tessera::http_api
