// SPDX-License-Identifier: Apache-2.0
// The scene files that come with Tessera, for the tests that render all of them.
#pragma once

#include <string>
#include <vector>

#include "core/scene/description.hpp"

namespace tessera::test {

// Every scenes/FOLDER/FILE.json as "FOLDER_FILE", or "FOLDER" where the file is scene.json; in order.
std::vector<std::string> shipped_scenes();

// The scene of that name. Fails the process with the loader's sentence if it cannot be read.
core::SceneDescription load_shipped_scene(const std::string& name);

}  // namespace tessera::test
