// SPDX-License-Identifier: Apache-2.0
// Meshes that others made, brought to the size and the pose of ours.
#pragma once

#include <string>

#include "core/base/error.hpp"
#include "core/scene/description.hpp"

namespace tessera::menagerie {

struct Pose {
  float yaw_degrees;  // counter-clockwise seen from above
  float height_cm;
};

// The mesh of the OBJ file at `path`, turned and scaled, standing on y = 0 with its middle at x = z = 0; with
// normals, and uvs where the file has them. Errors name the file.
core::Result<core::MeshDescription> read_original(const std::string& path, const Pose& pose);

}  // namespace tessera::menagerie
