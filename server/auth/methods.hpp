// SPDX-License-Identifier: Apache-2.0
// The table of methods: the role that each requires, and the limits of its messages, which are checked before
// a message is parsed. Immutable; thread-safe.
#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "server/auth/message_shape.hpp"
#include "server/auth/principal.hpp"
#include "server/limits.hpp"

namespace tessera::auth {

struct Method {
  std::string path;  // "/tessera.v1.RenderService/GetJob"
  Role role;
  std::size_t max_bytes;  // of one message of the caller
  ShapeLimits shape;
};

class Methods {
 public:
  explicit Methods(const server::Limits& limits);

  // Aborts if the table lacks the method: a service that adds one must add its row.
  const Method& at(const std::string& path) const;
  const std::map<std::string, Method>& all() const { return methods_; }

 private:
  std::map<std::string, Method> methods_;  // by path
};

}  // namespace tessera::auth
