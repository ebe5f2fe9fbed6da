// SPDX-License-Identifier: Apache-2.0
// Writes a scene in our own format: a scene file, PLY meshes, PNG and PFM images. What is written renders to
// the same bytes. Thread-safe for distinct scenes.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "core/scene/description.hpp"

namespace tessera::core {

// Creates the file with this name, relative to the scene file.
using WriteSceneFile = std::function<Status(const std::string& name, std::string_view bytes)>;

// Writes `name`.json, and all other files into a folder `name`.files beside it, one after the other. Names of
// materials and objects that are empty or not unique are changed. Fails as `write` does, and with
// RESOURCE_EXHAUSTED if memory runs out.
Status write_scene(const SceneDescription& scene, const std::string& name, const WriteSceneFile& write);

}  // namespace tessera::core
