// SPDX-License-Identifier: Apache-2.0
// How a coordinator validates submitted scenes: in tessera-validator, a confined process of its own.
#pragma once

#include <functional>
#include <string>

#include "core/base/error.hpp"
#include "server/blobs/blob_store.hpp"
#include "server/jobs/job_service.hpp"
#include "server/limits.hpp"

namespace tessera::server {

struct ValidatorOptions {
  std::string program;           // path of tessera-validator
  Limits limits{};               // on the content of scenes, and on what loading one takes
  bool require_sandbox = false;  // validate nothing if a part of the sandbox is missing
};

// FAILED_PRECONDITION: there is no such program, or a part of the required sandbox is missing. Otherwise
// each missing part goes to `warn` as one line.
core::Status check_validator(const ValidatorOptions& options,
                             const std::function<void(const std::string& line)>& warn);

// The check of scenes whose blobs are in `blobs`. Thread-safe.
jobs::SceneCheck confined_scene_check(ValidatorOptions options, const blobs::BlobStore& blobs);

}  // namespace tessera::server
