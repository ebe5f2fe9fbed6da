// SPDX-License-Identifier: Apache-2.0
// Who makes scenes of files: what another release, or another state of the sources, has made of the same
// files is not taken for what this one would make.
#pragma once

#include <string_view>

namespace tessera::core::stored {

// Of this build: the release, and a hash of the sources that decide what a scene is.
std::string_view scene_maker();

}  // namespace tessera::core::stored
