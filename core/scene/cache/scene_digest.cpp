// SPDX-License-Identifier: Apache-2.0
#include "core/scene/cache/scene_digest.hpp"

#include <fmt/format.h>

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

// Adds to the parts that are animated.
template <typename Camera, typename Instances, typename Lights, typename Materials, typename Media,
          typename Environment>
void mix_in(SceneDigest& digest, const Animation& animation, const Camera& camera, const Instances& instances,
            const Lights& lights, const Materials& materials, const Media& media,
            const Environment& environment) {
  const auto mix = [](Checksum& part, const auto& more) {
    part = checksum_of_parts(part.low, part.high, more);
  };
  if (is_animated(animation.camera)) mix(digest.camera, camera);
  if (!animation.instances.empty() || animation.deforms) mix(digest.shapes, instances);
  if (!animation.lights.empty()) mix(digest.lights, lights);
  if (!animation.materials.empty()) mix(digest.materials, materials);
  if (!animation.media.empty()) mix(digest.materials, media);
  if (!animation.environment.empty()) mix(digest.environment, environment);
}

}  // namespace

SceneDigest digest_of(const SceneDescription& scene) {
  const Animation& animation = scene.animation;
  SceneDigest digest{.camera = checksum_of_parts(scene.camera, scene.camera_medium),
                     .textures = checksum_of_parts(scene.textures),
                     .materials = checksum_of_parts(scene.materials, scene.grids, scene.media),
                     .shapes = checksum_of_parts(scene.objects, scene.shapes, scene.shape_names),
                     .lights = checksum_of_parts(scene.lights),
                     .environment = checksum_of_parts(scene.environment)};
  mix_in(digest, animation, animation.camera, animation.instances, animation.lights, animation.materials,
         animation.media, animation.environment);
  return digest;
}

std::vector<Checksum> digests_of_materials(const SceneDescription& scene) {
  std::vector<Checksum> digests;
  for (const Material& material : scene.materials) digests.push_back(checksum_of_parts(material));
  return digests;
}

std::string digest_text(const SceneDigest& digest) {
  std::string text;
  for (const Checksum& part :
       {digest.camera, digest.textures, digest.materials, digest.shapes, digest.lights, digest.environment})
    text += fmt::format("{:016x}{:016x}", part.high, part.low);
  return text;
}

SceneDigest digest_at_frame(const SceneDigest& scene, const Animation& animation, std::int32_t frame) {
  SceneDigest digest = scene;
  mix_in(digest, animation, frame, frame, frame, frame, frame, frame);
  return digest;
}

}  // namespace tessera::core
