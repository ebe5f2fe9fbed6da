// SPDX-License-Identifier: Apache-2.0
// How much a scene of unknown origin may hold. On one's own machine a scene may hold what the formats allow:
// that is the default. Plain data.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

namespace tessera::core {

struct SceneLimit {
  std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
  // What raises it, for the sentence of a refusal.
  std::string option;
};

struct SceneLimits {
  // Of all meshes, objects' included, as often as they are stored: a file that two shapes read counts twice,
  // an object with ten instances once.
  SceneLimit triangles;
  // Of one picture, and of all that textures are read from. A picture that is read in two colour spaces
  // counts twice.
  SceneLimit texture_pixels, scene_texture_pixels;
  // Emissive triangles, quads and spheres, with those of every instance.
  SceneLimit lights;
};

}  // namespace tessera::core
