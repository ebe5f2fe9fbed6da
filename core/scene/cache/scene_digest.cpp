// SPDX-License-Identifier: Apache-2.0
#include "core/scene/cache/scene_digest.hpp"

#include <array>
#include <span>

#include "core/scene/cache/archive.hpp"

namespace tessera::core {
namespace {

// A sink of blocks that keeps one checksum of all of them.
struct BlockChecksum {
  Checksum sum;

  void write_block(std::span<const std::byte> block) { add(checksum_of(block)); }
  void add(const Checksum& next) {
    const std::array<Checksum, 2> both{sum, next};
    sum = checksum_of(std::as_bytes(std::span(both)));
  }
};

template <typename... Parts>
Checksum checksum_of_parts(const Parts&... parts) {
  BlockChecksum blocks;
  stored::Writer writer(blocks);
  (writer(parts), ...);
  blocks.add(checksum_of(writer.bytes()));
  return blocks.sum;
}

}  // namespace

SceneDigest digest_of(const SceneDescription& scene) {
  return {.camera = checksum_of_parts(scene.camera),
          .textures = checksum_of_parts(scene.textures),
          .materials = checksum_of_parts(scene.materials),
          .shapes = checksum_of_parts(scene.objects, scene.shapes),
          .lights = checksum_of_parts(scene.lights),
          .environment = checksum_of_parts(scene.environment)};
}

}  // namespace tessera::core
