// SPDX-License-Identifier: Apache-2.0
#include "server/jobs/continuation.hpp"

#include <fmt/format.h>

namespace tessera::jobs {

core::Status may_continue(const farm::JobRecord& record, const std::string& fingerprint) {
  if (record.arithmetic.empty() || record.arithmetic == fingerprint) return {};
  return core::fail(
      core::ErrorCode::kFailedPrecondition,
      fmt::format(
          "job {} was rendered by workers of another build (fingerprint {}; this farm's is {}), and "
          "its image cannot be continued by these: submit the scene again, or start the coordinator with "
          "--accept-fingerprint {} and workers of that build",
          record.spec->id(), record.arithmetic, fingerprint, record.arithmetic));
}

}  // namespace tessera::jobs
