// SPDX-License-Identifier: Apache-2.0
// Identifies the build that prepares a scene, so that cached results of other releases or source states are
// not used.
#pragma once

#include <string_view>

namespace tessera::core::stored {

// The release, and a hash of the sources that determine a prepared scene.
std::string_view scene_maker();

}  // namespace tessera::core::stored
