// SPDX-License-Identifier: Apache-2.0
// A job as this worker knows it, once its scene's files lie in the cache. Immutable.
#pragma once

#include <map>
#include <string>

#include "core/scene/settings.hpp"
#include "proto/blob.hpp"
#include "tessera/v1/types.pb.h"

namespace tessera::worker {

// A bundle on this machine.
struct SceneFiles {
  // Equal for equal bundles, whatever job they came with.
  std::string key;
  // The scene file's name in the bundle.
  std::string scene_path;
  // Where the cache keeps the file that the bundle calls by this name.
  std::map<std::string, std::string> blob_paths;
  // What is in it.
  std::map<std::string, proto::Digest> digests{};
};

struct Job {
  std::string id;
  // What the picture depends on; leases say which samples to take.
  core::RenderSettings settings;
  SceneFiles files;
};

// The SceneFiles::key of a bundle.
std::string bundle_key(const v1::Bundle& bundle);

}  // namespace tessera::worker
