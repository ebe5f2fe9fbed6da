// SPDX-License-Identifier: Apache-2.0
#include "server/dispatch/caller.hpp"

#include <fmt/format.h>

namespace tessera::dispatch {

bool is_worker_id(const std::string& text) {
  return text.size() == 32 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

core::Status expect_own(const scheduler::WorkerInfo* known, const std::string& principal) {
  if (known == nullptr || known->principal == principal) return {};
  return core::fail(
      core::ErrorCode::kPermissionDenied,
      fmt::format("worker {} ({}) was registered by the principal '{}', and '{}' calls: a worker "
                  "keeps the credentials with which it has started",
                  known->name, known->id.value, known->principal, principal));
}

}  // namespace tessera::dispatch
