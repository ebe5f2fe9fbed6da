// SPDX-License-Identifier: Apache-2.0
// Tells builds apart whose arithmetic differs.
#pragma once

#include <string>

#include "core/scene/description.hpp"

namespace tessera::core {

// A scene that has something of everything, but for the reading of files.
SceneDescription fingerprint_scene();

// 16 hexadecimal digits: a hash of the exact film of the scene above. Machines whose fingerprints are
// equal render the same bytes, as far as that scene can tell. Takes some milliseconds.
std::string determinism_fingerprint();

}  // namespace tessera::core
