// SPDX-License-Identifier: Apache-2.0
// Who may call what: the bearer tokens of a farm and their roles. Immutable; thread-safe.
#pragma once

#include <grpcpp/server_context.h>

#include <map>
#include <string>
#include <string_view>

#include "core/base/error.hpp"

namespace tessera::rpc {

enum class Role {
  kSubmit,  // everything users do, but changes to the jobs of others
  kWork,    // everything workers do
  kAdmin,   // everything
};

struct Caller {
  std::string name;  // empty where the farm knows no tokens
  Role role = Role::kAdmin;
  std::string key;  // tells callers apart, also where they have no names (AuthInterceptor)
};

class Access {
 public:
  // Everybody may do everything.
  Access() = default;

  // From a file with a line "ROLE NAME TOKEN" for each token, ROLE one of submit, work and admin; several
  // tokens may have one name. Empty lines and lines that begin with # count for nothing. Errors name file and
  // line.
  static core::Result<Access> read(const std::string& path);

  // Whether no token is asked for.
  bool is_open() const { return open_; }

  // Who calls, if the caller's token has this role or is an administrator's. UNAUTHENTICATED without a known
  // token, PERMISSION_DENIED without the role; the sentence is in the status.
  grpc::Status admit(const grpc::CallbackServerContext& context, Role role, Caller& caller) const;

 private:
  core::Status add_line(std::string_view line);

  bool open_ = true;
  std::map<std::string, Caller>
      callers_;  // by the SHA-256 of the token, so that a look-up's time tells nothing of it
};

}  // namespace tessera::rpc
