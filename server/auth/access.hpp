// SPDX-License-Identifier: Apache-2.0
// Authorisation: the bearer tokens of a farm and their roles. Immutable; thread-safe.
#pragma once

#include <grpcpp/server_context.h>

#include <map>
#include <string>
#include <string_view>

#include "core/base/error.hpp"

namespace tessera::auth {

enum class Role {
  kSubmit,  // calls of users, except changes to the jobs of others
  kWork,    // calls of workers
  kAdmin,   // all calls
};

struct Caller {
  std::string name;  // empty if the farm has no tokens
  Role role = Role::kAdmin;
  std::string key;  // distinguishes callers, also those without names (AuthInterceptor)
};

class Access {
 public:
  // Everybody may call everything.
  Access() = default;

  // Reads a file with a line "ROLE NAME TOKEN" for each token. ROLE is submit, work or admin; several tokens
  // may have the same name. Empty lines and lines that begin with # are ignored. Errors name file and line.
  static core::Result<Access> read(const std::string& path);

  // Whether calls need no token.
  bool is_open() const { return open_; }

  // Identifies the caller and checks that the token has this role or is an administrator's. UNAUTHENTICATED
  // without a known token, PERMISSION_DENIED without the role. The status has the message.
  grpc::Status admit(const grpc::CallbackServerContext& context, Role role, Caller& caller) const;

 private:
  core::Status add_line(std::string_view line);

  bool open_ = true;
  std::map<std::string, Caller>
      callers_;  // by the SHA-256 of the token, so that the look-up time reveals nothing of it
};

}  // namespace tessera::auth
