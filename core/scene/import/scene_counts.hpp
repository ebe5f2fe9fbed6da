// SPDX-License-Identifier: Apache-2.0
// Sizes of a scene, for people who want to know what is in a file. Stateless; thread-safe.
#pragma once

#include <cstdint>
#include <map>
#include <string_view>

#include "core/scene/description.hpp"

namespace tessera::core {

struct SceneCounts {
  std::uint64_t triangles = 0;                          // stored once for all instances
  std::uint64_t triangles_with_instances = 0;           // as many as rays can hit
  std::uint64_t deforming_triangles = 0;                // stored ones of meshes that deform
  std::uint64_t curve_segments = 0;                     // stored
  std::map<std::string_view, std::uint64_t> shapes;     // stored ones by type, "mesh": 3, with instances
  std::map<std::string_view, std::uint64_t> materials;  // by type
  std::map<std::string_view, std::uint64_t> lights;     // by type
  std::uint64_t emissive_shapes = 0;                    // triangles and other shapes, again for each instance
  std::uint64_t images = 0, image_pixels = 0;           // of textures; shared ones once
  // An estimate of what the scene takes while it is rendered, without the film: geometry, images, grids and
  // the acceleration structure.
  std::uint64_t memory_bytes = 0;
};

SceneCounts count_scene(const SceneDescription& scene);
// What the texels of an image take.
std::uint64_t image_bytes(const TextureImage& image);

}  // namespace tessera::core
