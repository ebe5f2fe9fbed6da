// SPDX-License-Identifier: Apache-2.0
// Limits on the size of a scene from an untrusted source, and on what is told of it. The default is no limit
// on sizes beyond the formats', for local scenes. Plain data.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include "core/scene/loader/file_warnings.hpp"

namespace tessera::core {

struct SceneLimit {
  std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
  // The option that raises the limit, for error messages.
  std::string option;
};

struct SceneLimits {
  // Triangles of all meshes, including objects', as stored: a file used by two shapes counts twice, an
  // object with ten instances once. A segment of a curve counts as eight.
  SceneLimit triangles;
  // Pixels of one image, and of all texture images. An image that is read in two colour spaces counts
  // twice.
  SceneLimit texture_pixels, scene_texture_pixels;
  // Emissive triangles and other shapes, including those of every instance.
  SceneLimit lights;
  WarningLimits warnings{};
};

}  // namespace tessera::core
