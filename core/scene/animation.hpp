// SPDX-License-Identifier: Apache-2.0
// Keyframed parameters of a scene: those of the camera, of lights, and the placements of instances. Numbers,
// points and colours are interpolated linearly between two keyframes, rotations by slerp; before the first
// keyframe and after the last one, values are constant. Geometry and materials do not change. Plain data and
// pure functions.
#pragma once

#include <algorithm>
#include <cstdint>
#include <variant>
#include <vector>

#include "core/camera/camera_description.hpp"
#include "core/math/quaternion.hpp"
#include "core/math/rgb.hpp"
#include "core/math/transform.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core {

// The largest angle of a keyframe: larger ones would lose the accuracy of sine.
inline constexpr float kMaxTurnDegrees = 3600;

// The values of a parameter over time. Empty if the parameter is not animated.
template <typename T>
struct Track {
  std::vector<float> frames;  // increasing
  std::vector<T> values;      // one for each frame

  bool empty() const { return frames.empty(); }
};

template <typename T>
T interpolate(T a, T b, float t) {
  return a + (b - a) * t;
}
inline Quaternion interpolate(Quaternion a, Quaternion b, float t) {
  return slerp(a, b, t);
}

// The value at a frame; `otherwise` if the parameter is not animated. At a keyframe it is exactly the
// keyframe's.
template <typename T>
T value_at(const Track<T>& track, float frame, T otherwise) {
  if (track.empty()) return otherwise;
  const auto after = std::upper_bound(track.frames.begin(), track.frames.end(), frame);
  if (after == track.frames.begin()) return track.values.front();
  if (after == track.frames.end()) return track.values.back();
  const auto next = static_cast<std::size_t>(after - track.frames.begin());
  const float begin = track.frames[next - 1];
  return interpolate(track.values[next - 1], track.values[next],
                     (frame - begin) / (track.frames[next] - begin));
}

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

// The steps of an animated transform.
struct ScaleMotion {
  Track<Vec3> factors;
};
struct TurnMotion {  // about a fixed axis, also by several turns
  Vec3 axis{0, 1, 0};
  Track<float> degrees;
};
struct RotationMotion {
  Track<Quaternion> rotations;
};
struct TranslationMotion {
  Track<Vec3> offsets;
};
using MotionStep = std::variant<Transform, ScaleMotion, TurnMotion, RotationMotion, TranslationMotion>;

// Of one of SceneDescription::shapes, which is an instance.
struct InstanceMotion {
  std::uint32_t shape = 0;
  std::vector<MotionStep> steps;  // applied in this order
};

struct Animation {
  CameraAnimation camera;
  std::vector<LightAnimation> lights;
  std::vector<InstanceMotion> instances;
};

bool is_animated(const CameraAnimation& camera);
inline bool is_animated(const Animation& animation) {
  return is_animated(animation.camera) || !animation.lights.empty() || !animation.instances.empty();
}

// The transform at a frame.
Transform transform_at(const std::vector<MotionStep>& steps, float frame);
// `camera` with the parameters that are animated at a frame.
CameraDescription camera_at(const CameraDescription& camera, const CameraAnimation& animation, float frame);

// Whether each track has as many values as frames, finite frames that increase, and angles and quaternions
// that can be computed with.
bool is_sound(const Animation& animation);

}  // namespace tessera::core
