// SPDX-License-Identifier: Apache-2.0
// Distinguishes builds that are not bit-compatible.
#pragma once

#include <string>

#include "core/scene/description.hpp"

namespace tessera::core::integrators {

// A scene with every kind of light, the materials and shapes that batches shade, and a texture decoded from
// JPEG.
SceneDescription fingerprint_scene();

// 16 hexadecimal digits: a hash of the exact films of the scene above, of one with layered materials, disks
// and cylinders, with and without media, and of one with curves and what moves. Machines with equal
// fingerprints render the same bytes, as far as these scenes can tell. Takes some tenths of a second.
std::string determinism_fingerprint();

}  // namespace tessera::core::integrators
