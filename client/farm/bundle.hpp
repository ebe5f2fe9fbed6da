// SPDX-License-Identifier: Apache-2.0
// A scene on this machine as a bundle: loaded and checked here first, so that a mistake is told before
// anything is sent, in the words in which `tessera render` tells it.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "client/farm/farm.hpp"
#include "core/scene/settings.hpp"

namespace tessera::client {

struct LocalBundle {
  v1::Bundle bundle;
  std::string folder;                        // the scene file's
  std::map<std::string, std::string> paths;  // the files in it, by their names in the bundle
  core::RenderSettings settings;             // the scene's, with the overrides
  bool gives_light = true;
  std::vector<std::string> warnings;  // about the scene's files
};

core::Result<LocalBundle> bundle_scene(const std::string& scene_path, const core::RenderOverrides& overrides);

// Sends what the coordinator lacks. Blocks. An error too if a file has changed since it was bundled.
core::Status upload_missing(Farm& farm, const LocalBundle& bundle);

}  // namespace tessera::client
