// SPDX-License-Identifier: Apache-2.0
#include "server/scene_check.hpp"

#include <stop_token>
#include <utility>
#include <vector>

#include "core/sandbox/check.hpp"
#include "server/validator/validator_process.hpp"

namespace tessera::server {

core::Status check_validator(const ValidatorOptions& options,
                             const std::function<void(const std::string& line)>& warn) {
  if (core::Status found = validator::check_validator(options.program); !found) return found;
  return sandbox::check_sandbox(options.program, options.require_sandbox, warn);
}

jobs::SceneCheck confined_scene_check(ValidatorOptions options, const blobs::BlobStore& blobs) {
  return
      [options = std::move(options), blobs](const v1::Bundle& bundle, const v1::RenderOverrides& overrides,
                                            const std::vector<std::int32_t>& frames,
                                            const std::stop_token& stop) -> core::Result<jobs::CheckedScene> {
        const validator::ProcessOptions process{.path = options.program,
                                                .limits = options.limits,
                                                .stop = stop,
                                                .require_sandbox = options.require_sandbox};
        auto approval = validator::validate_scene(process, blobs, {bundle, overrides, frames});
        if (!approval) return core::fail(approval.error());
        return jobs::CheckedScene{approval->settings, approval->display, std::move(approval->warnings),
                                  std::move(approval->scene_digests), std::move(approval->attributes)};
      };
}

}  // namespace tessera::server
