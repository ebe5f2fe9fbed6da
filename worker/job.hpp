// SPDX-License-Identifier: Apache-2.0
// A job whose scene files are in the cache. Immutable.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/scene/settings.hpp"
#include "proto/blob.hpp"
#include "tessera/v1/types.pb.h"

namespace tessera::worker {

// The files of a bundle on this machine.
struct SceneFiles {
  // Equal for equal bundles, whatever their job.
  std::string key;
  // The scene file's name in the bundle.
  std::string scene_path;
  // The path of each file in the cache by its name in the bundle.
  std::map<std::string, std::string> blob_paths;
  // The digests by the same names.
  std::map<std::string, proto::Digest> digests{};
};

struct Job {
  std::string id;
  // The settings that determine the image; leases name the samples to render.
  core::RenderSettings settings;
  SceneFiles files;
  // Of the images that items name, by their numbers; empty: one image, of frame 0.
  std::vector<std::int32_t> frames{};

  std::int32_t frame_of(std::uint32_t image) const { return image < frames.size() ? frames[image] : 0; }
};

// The SceneFiles::key of a bundle.
std::string bundle_key(const v1::Bundle& bundle);

}  // namespace tessera::worker
