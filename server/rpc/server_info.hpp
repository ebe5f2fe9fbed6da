// SPDX-License-Identifier: Apache-2.0
// What a coordinator tells of itself, and of its caller. A pure function.
#pragma once

#include <cstdint>
#include <set>
#include <string>

#include "server/auth/principal.hpp"
#include "server/limits.hpp"
#include "tessera/v1/render_service.pb.h"

namespace tessera::rpc {

struct ServerFacts {
  std::set<std::string> fingerprints;  // accepted ones
  std::int64_t started_ms = 0;         // since 1970-01-01 UTC
  bool is_open = false;                // calls need no credentials
};

v1::GetServerInfoResponse server_info(const ServerFacts& facts, const server::Limits& limits,
                                      const auth::Principal& caller);

}  // namespace tessera::rpc
