// Asks tessera-validator about a scene: starts it, waits for it, and turns whatever becomes of it into an
// answer. Thread-safe.
#pragma once

#include <chrono>
#include <string>

#include "core/base/error.hpp"
#include "server/store/blob_store.hpp"
#include "tessera/v1/types.pb.h"

namespace tessera::validator {

struct ProcessOptions {
  // The executable.
  std::string path;
  // After so long it is killed.
  std::chrono::milliseconds timeout = std::chrono::minutes(5);
};

// The executable next to this process's own.
std::string default_validator_path();

// The settings with which the bundle would be rendered. Its blobs must be in `blobs`. Blocks.
// INVALID_ARGUMENT also if the validator crashed or ran out of time over it; INTERNAL if it could not be
// started.
core::Result<v1::RenderSettings> validate_scene(const ProcessOptions& options, const store::BlobStore& blobs,
                                                const v1::Bundle& bundle,
                                                const v1::RenderOverrides& overrides);

}  // namespace tessera::validator
