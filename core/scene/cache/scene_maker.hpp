// SPDX-License-Identifier: Apache-2.0
// Identifies the build that prepares a scene, so that cached results of other releases or source states are
// not used.
#pragma once

#include <string_view>

#include "core/scene/cache/block_file.hpp"

namespace tessera::core::stored {

// The release, and a hash of the sources that determine a prepared scene.
std::string_view scene_maker();

// The version of the block files of this build.
Checksum file_version();

}  // namespace tessera::core::stored
