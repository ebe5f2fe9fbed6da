// SPDX-License-Identifier: Apache-2.0
// Every method that callers can reach, with who may call it and how large its messages may be: what is
// checked before a message is parsed. Immutable; thread-safe.
#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "server/limits.hpp"
#include "server/rpc/access.hpp"
#include "server/rpc/message_shape.hpp"

namespace tessera::rpc {

struct Method {
  std::string path;  // "/tessera.v1.RenderService/GetJob"
  Role role;
  std::size_t max_bytes;  // of one message of the caller
  ShapeLimits shape;
};

class Methods {
 public:
  explicit Methods(const server::Limits& limits);

  // Ends the process if there is no such method: whoever serves one has forgotten to add it to the table.
  const Method& at(const std::string& path) const;
  const std::map<std::string, Method>& all() const { return methods_; }

 private:
  std::map<std::string, Method> methods_;  // by path
};

}  // namespace tessera::rpc
