// SPDX-License-Identifier: Apache-2.0
// Motions through transforms that a file gives for some times: translations and stretches are interpolated
// linearly, rotations by slerp (Shoemake and Duff 1992), as other programs do. Stateless; thread-safe.
#pragma once

#include <optional>
#include <vector>

#include "core/camera/camera_description.hpp"
#include "core/math/motion.hpp"
#include "core/math/transform.hpp"
#include "core/scene/animation.hpp"

namespace tessera::core {

struct KeyedTransform {
  float frame = 0;
  Transform transform{};

  bool operator==(const KeyedTransform&) const = default;
};
using KeyedTransforms = std::vector<KeyedTransform>;  // at least one; frames increase

struct TransformMotion {
  std::vector<MotionStep> steps;
  bool is_exact = true;  // else the stretch, which is not along axes, stays that of the first transform
};
// nullopt if a transform flattens space, or if some of them reflect and others do not.
std::optional<TransformMotion> motion_through(const KeyedTransforms& keys);

// What appears in the middle of the image of a camera at `position` that looks along `forward`: so far away
// that it keeps its accuracy.
Vec3 look_at_along(Vec3 position, Vec3 forward);

// Lets the camera move through the transforms: it looks along their z axes, with their y axes up. Sets the
// camera as at frame 0. False if there is no such motion.
bool animate_camera(const KeyedTransforms& keys, CameraDescription& camera, CameraAnimation& animation);

}  // namespace tessera::core
