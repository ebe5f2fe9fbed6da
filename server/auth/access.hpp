// SPDX-License-Identifier: Apache-2.0
// Authentication and authorisation: the tokens and certificates of a farm and their roles. Immutable;
// thread-safe.
#pragma once

#include <grpcpp/support/status.h>

#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "server/auth/credentials.hpp"
#include "server/auth/principal.hpp"

namespace tessera::auth {

class Access {
 public:
  using Time = std::chrono::system_clock::time_point;

  // Everybody may call everything.
  Access() = default;

  // Reads a file with a line for each token or certificate:
  //
  //   ROLE NAME TOKEN [shared] [expires=TIME]
  //   ROLE NAME certificate [shared] [expires=TIME]
  //
  // ROLE is watch, submit, work or admin. Several lines may have the same name. `certificate` stands for a
  // client certificate with the common name NAME, which needs no token. TIME is a date, which includes its
  // last second, or a time of RFC 3339; a date is in UTC. Without `shared`, the credentials are individual.
  // Empty lines and lines that begin with # are ignored. Errors name file and line.
  static core::Result<Access> read(const std::string& path);

  // Whether calls need no credentials.
  bool is_open() const { return open_; }

  // Identifies the caller and checks that its role includes this one. UNAUTHENTICATED without
  // known, valid credentials, PERMISSION_DENIED without the role. The status has the message. `principal`
  // gets name, role and whether it is individual, as far as it is known.
  grpc::Status admit(const Credentials& shown, Role role, Time now, Principal& principal) const;

 private:
  struct Grant {
    Principal principal;
    std::optional<Time> expires{};
  };

  core::Status add_line(std::string_view line);
  core::Status add_token(const std::string& token, Grant grant);
  // Null if the credentials are unknown.
  const Grant* find(const Credentials& shown) const;

  bool open_ = true;
  // By the SHA-256 of the token, so that the look-up time reveals nothing of it.
  std::map<std::string, Grant> tokens_;
  std::map<std::string, Grant> certificates_;  // by common name
};

}  // namespace tessera::auth
