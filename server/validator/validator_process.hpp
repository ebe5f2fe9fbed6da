// SPDX-License-Identifier: Apache-2.0
// Asks tessera-validator about a scene: starts it, waits for it, and turns whatever becomes of it into an
// answer. Thread-safe.
#pragma once

#include <chrono>
#include <stop_token>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "server/limits.hpp"
#include "server/store/blob_store.hpp"
#include "tessera/v1/types.pb.h"

namespace tessera::validator {

struct ProcessOptions {
  // The executable.
  std::string path;
  // What a scene may hold, and what loading it may take.
  server::Limits limits{};
  // When this is requested it is killed, and none is started any more.
  std::stop_token stop{};
};

inline constexpr int kMaxWarnings = 101;
inline constexpr std::size_t kMaxWarningBytes = 1000;

// What is said of a scene that can be rendered.
struct Approval {
  v1::RenderSettings settings;        // overrides applied
  v1::DisplaySettings display;        // the scene file's
  std::vector<std::string> warnings;  // kMaxWarnings at most, cut to kMaxWarningBytes
};

// The executable next to this process's own.
std::string default_validator_path();

// FAILED_PRECONDITION if there is no program to start at this path: every scene would be refused.
core::Status check_validator(const std::string& path);

// How the bundle would be rendered and shown. Its blobs must be in `blobs`. Blocks.
// RESOURCE_EXHAUSTED: the scene is beyond a limit, or could not be loaded within time and memory.
// INVALID_ARGUMENT also if the validator crashed over it; INTERNAL if it could not be started; UNAVAILABLE
// after a stop.
core::Result<Approval> validate_scene(const ProcessOptions& options, const store::BlobStore& blobs,
                                      const v1::Bundle& bundle, const v1::RenderOverrides& overrides);

}  // namespace tessera::validator
