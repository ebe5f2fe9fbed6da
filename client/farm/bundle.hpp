// SPDX-License-Identifier: Apache-2.0
// A local scene as a bundle. It is loaded and validated locally first, so that mistakes are reported before
// anything is sent, with the messages of `tessera render`.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/scene/loader/parameter_override.hpp"
#include "core/scene/settings.hpp"
#include "tessera/v1/types.pb.h"

namespace tessera::client {

struct LocalBundle {
  v1::Bundle bundle;
  std::string name;                          // the scene's; empty if no job can be called so
  std::string folder;                        // the folder of the scene file
  std::map<std::string, std::string> paths;  // local paths by name in the bundle
  core::RenderSettings settings;             // the scene's, with the overrides
  bool gives_light = true;
  bool frames_differ = false;         // the scene has keyframes
  bool ignores_media = false;         // the integrator renders it as if it had no media
  std::vector<std::string> warnings;  // about the scene's files
  // The scene file of the bundle, if parameters were replaced in it.
  std::optional<std::string> scene_text{};
};

// What to render of a scene file.
struct SceneChoice {
  core::RenderOverrides overrides{};
  std::vector<core::ParameterOverride> parameters{};
  std::vector<std::int32_t> frames{};  // empty: frame 0
};

core::Result<LocalBundle> bundle_scene(const std::string& scene_path, const SceneChoice& choice);

// Whether the bundle's warnings have one that a coordinator, which knows only names in the bundle, writes
// like this.
bool has_warning(const LocalBundle& local, const std::string& warning);

}  // namespace tessera::client
