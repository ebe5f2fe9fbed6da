// SPDX-License-Identifier: Apache-2.0
// Runs tessera-validator for a scene: starts it, waits for it, and converts its output or failure into an
// answer. Thread-safe.
#pragma once

#include <chrono>
#include <cstdint>
#include <stop_token>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "server/blobs/blob_store.hpp"
#include "server/limits.hpp"
#include "tessera/v1/types.pb.h"

namespace tessera::validator {

struct ProcessOptions {
  // The path of the executable.
  std::string path;
  // Limits on the content of a scene, and on the memory and time of loading it.
  server::Limits limits{};
  // A stop request kills the process; no other is started after it.
  std::stop_token stop{};
  // Validate nothing if a part of the sandbox is missing.
  bool require_sandbox = false;
};

inline constexpr int kMaxWarnings = 101;
inline constexpr std::size_t kMaxWarningBytes = 1000;

// The settings of a scene that can be rendered.
struct Approval {
  v1::RenderSettings settings;        // overrides applied
  v1::DisplaySettings display;        // of the scene file
  std::vector<std::string> warnings;  // at most kMaxWarnings, each cut to kMaxWarningBytes
  // Of a scene with layers: see tessera.v1.Job.
  std::vector<std::string> scene_digests{};
  std::vector<v1::TextAttribute> attributes{};
};

// The executable beside this process's own.
std::string default_validator_path();

// FAILED_PRECONDITION if there is no executable at this path: every scene would be refused.
core::Status check_validator(const std::string& path);

struct SceneToValidate {
  const v1::Bundle& bundle;
  const v1::RenderOverrides& overrides;
  // Each must be one that the scene can be rendered at. Empty: frame 0.
  const std::vector<std::int32_t>& frames;
};

// The settings of the bundle. Its blobs must be in `blobs`. Blocks. RESOURCE_EXHAUSTED: the scene exceeds a
// limit, or could not be loaded within time and memory. INVALID_ARGUMENT also if the validator crashed;
// INTERNAL if it could not be started; UNAVAILABLE after a stop request.
core::Result<Approval> validate_scene(const ProcessOptions& options, const blobs::BlobStore& blobs,
                                      const SceneToValidate& scene);

}  // namespace tessera::validator
