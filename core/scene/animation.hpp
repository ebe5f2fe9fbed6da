// SPDX-License-Identifier: Apache-2.0
// Keyframed parameters of a scene: those of the camera, of lights, materials, media and the environment, and
// the placements of instances. Meshes that deform have their steps themselves. Plain data and pure functions.
#pragma once

#include <cstdint>
#include <vector>

#include "core/camera/camera_description.hpp"
#include "core/math/motion.hpp"
#include "core/math/rgb.hpp"
#include "core/math/track.hpp"
#include "core/math/vec3.hpp"
#include "core/scene/parameter_tracks.hpp"

namespace tessera::core {

struct CameraAnimation {
  Track<Vec3> position, look_at, up;
  Track<float> vertical_fov_degrees, aperture_radius, focus_distance, aperture_rotation_degrees;
  Track<float> view_height{};
  Track<Vec2> lens_shift{};
};

// Of one of SceneDescription::lights. The tracks of keys that its type does not have are empty.
struct LightAnimation {
  std::uint32_t light = 0;
  Track<Vec3> position{}, look_at{}, direction{};
  Track<Rgb> color{};  // the intensity or irradiance
  Track<float> angle_degrees{}, softness{};
};

// Of one of SceneDescription::shapes, which is an instance.
struct InstanceMotion {
  std::uint32_t shape = 0;
  std::vector<MotionStep> steps;  // applied in this order
};

struct Animation {
  CameraAnimation camera;
  std::vector<LightAnimation> lights;
  std::vector<InstanceMotion> instances;
  std::vector<IndexedTracks> materials{}, media{};
  ParameterTracks environment{};
  bool deforms = false;  // there are meshes with steps

  // Whether surfaces, or what is between them, look different from frame to frame.
  bool changes_materials() const { return !materials.empty() || !media.empty(); }
};

bool is_animated(const CameraAnimation& camera);
inline bool is_animated(const Animation& animation) {
  return is_animated(animation.camera) || !animation.lights.empty() || !animation.instances.empty() ||
         animation.changes_materials() || !animation.environment.empty() || animation.deforms;
}

// `camera` with the parameters that are animated at a frame.
CameraDescription camera_at(const CameraDescription& camera, const CameraAnimation& animation, float frame);

// `all` as they are at a frame, where they have keyframes.
template <typename Values>
std::vector<Values> all_at(std::vector<Values> all, const std::vector<IndexedTracks>& animations,
                           float frame) {
  for (const auto& [index, tracks] : animations) all[index] = values_at(all[index], tracks, frame);
  return all;
}

// Whether each track has as many values as frames, finite frames that increase, and angles and quaternions
// that can be computed with.
bool is_sound(const Animation& animation);

}  // namespace tessera::core
