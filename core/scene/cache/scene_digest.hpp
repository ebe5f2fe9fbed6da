// SPDX-License-Identifier: Apache-2.0
// Identifies a scene by what its files contain: two scenes with the same digest render the same samples.
#pragma once

#include <string>
#include <vector>

#include "core/scene/cache/block_file.hpp"
#include "core/scene/description.hpp"

namespace tessera::core {

// One checksum for each part, so that a difference can be named. A part that is animated includes its
// keyframes. Settings, output settings and warnings are not part of it, nor are the names of files, except in
// the names of shapes, which Cryptomatte layers hold.
struct SceneDigest {
  Checksum camera, textures, materials, shapes, lights, environment;
  bool operator==(const SceneDigest&) const = default;
};

SceneDigest digest_of(const SceneDescription& scene);
// One checksum for each material, without those of animations.
std::vector<Checksum> digests_of_materials(const SceneDescription& scene);
// All of it in hexadecimal digits, for files and messages.
std::string digest_text(const SceneDigest& digest);
// The digest of the scene at a frame, from that of the scene.
SceneDigest digest_at_frame(const SceneDigest& scene, const Animation& animation, std::int32_t frame);

}  // namespace tessera::core
