// SPDX-License-Identifier: Apache-2.0
// Principals: who calls, by the credentials that a call shows. Plain values.
#pragma once

#include <string>
#include <string_view>

namespace tessera::auth {

enum class Role {
  kWatch,   // calls that show jobs and workers, and change nothing
  kSubmit,  // calls of users, except changes to the jobs of others
  kWork,    // calls of workers
  kAdmin,   // all calls
};

// Whether a caller with one role may make calls that need another one.
constexpr bool includes(Role role, Role needed) {
  return role == needed || role == Role::kAdmin || (role == Role::kSubmit && needed == Role::kWatch);
}

// "watch", "submit", "work" or "admin".
constexpr std::string_view role_name(Role role) {
  switch (role) {
    case Role::kWatch:
      return "watch";
    case Role::kSubmit:
      return "submit";
    case Role::kWork:
      return "work";
    case Role::kAdmin:
      return "admin";
  }
  return "";
}

struct Principal {
  // The name of its token, or the common name of its certificate. Empty for a caller without credentials on
  // an open farm.
  std::string name{};
  Role role = Role::kAdmin;
  // The credentials belong to one machine or person. Otherwise any number of machines may have them.
  bool individual = false;
  // The machine that it calls from (peer.hpp). A caller cannot choose it, but several may share it.
  std::string machine{};
  // Distinguishes callers for quotas and rates, also those without names (AuthInterceptor).
  std::string key{};
};

}  // namespace tessera::auth
