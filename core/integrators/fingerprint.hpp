// SPDX-License-Identifier: Apache-2.0
// Distinguishes builds that are not bit-compatible.
#pragma once

#include <string>

#include "core/scene/description.hpp"

namespace tessera::core {

// A scene with every kind of light, material and shape, and a texture decoded from JPEG.
SceneDescription fingerprint_scene();

// 16 hexadecimal digits: a hash of the exact film of the scene above. Machines with equal fingerprints
// render the same bytes, as far as that scene can tell. Takes some milliseconds.
std::string determinism_fingerprint();

}  // namespace tessera::core
