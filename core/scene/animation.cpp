// SPDX-License-Identifier: Apache-2.0
#include "core/scene/animation.hpp"

#include <cmath>
#include <functional>

#include "core/base/overloaded.hpp"

namespace tessera::core {
namespace {

template <typename T>
bool is_sound_track(const Track<T>& track) {
  const auto& frames = track.frames;
  return frames.size() == track.values.size() &&
         std::all_of(frames.begin(), frames.end(), [](float frame) { return std::isfinite(frame); }) &&
         std::adjacent_find(frames.begin(), frames.end(), std::greater_equal<>()) == frames.end();
}

template <typename... Tracks>
bool are_sound_tracks(const Tracks&... tracks) {
  return (is_sound_track(tracks) && ...);
}

bool is_sound_turn(const TurnMotion& turn) {
  return is_sound_track(turn.degrees) &&
         std::all_of(turn.degrees.values.begin(), turn.degrees.values.end(),
                     [](float degrees) { return std::fabs(degrees) <= kMaxTurnDegrees; });
}

bool is_sound_rotation(const RotationMotion& rotation) {
  const auto is_unit = [](Quaternion q) {
    return std::fabs(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z - 1) < 1e-3f;
  };
  const auto& rotations = rotation.rotations;
  return is_sound_track(rotations) && std::all_of(rotations.values.begin(), rotations.values.end(), is_unit);
}

bool is_sound_step(const MotionStep& step) {
  return std::visit(Overloaded{[](const Transform&) { return true; },
                               [](const ScaleMotion& scale) { return is_sound_track(scale.factors); },
                               [](const TurnMotion& turn) { return is_sound_turn(turn); },
                               [](const RotationMotion& turn) { return is_sound_rotation(turn); },
                               [](const TranslationMotion& move) { return is_sound_track(move.offsets); }},
                    step);
}

Transform step_at(const MotionStep& step, float frame) {
  return std::visit(Overloaded{[](const Transform& constant) { return constant; },
                               [frame](const ScaleMotion& scale) {
                                 return scaling(value_at(scale.factors, frame, Vec3{1, 1, 1}));
                               },
                               [frame](const TurnMotion& turn) {
                                 return rotation(turn.axis, value_at(turn.degrees, frame, 0.0f));
                               },
                               [frame](const RotationMotion& turn) {
                                 return rotation(value_at(turn.rotations, frame, Quaternion{}));
                               },
                               [frame](const TranslationMotion& move) {
                                 return translation(value_at(move.offsets, frame, Vec3{}));
                               }},
                    step);
}

}  // namespace

bool is_animated(const CameraAnimation& c) {
  return !(c.position.empty() && c.look_at.empty() && c.up.empty() && c.vertical_fov_degrees.empty() &&
           c.aperture_radius.empty() && c.focus_distance.empty() && c.aperture_rotation_degrees.empty() &&
           c.view_height.empty() && c.lens_shift.empty());
}

Transform transform_at(const std::vector<MotionStep>& steps, float frame) {
  Transform all;
  for (const MotionStep& step : steps) all = compose(step_at(step, frame), all);
  return all;
}

CameraDescription camera_at(const CameraDescription& camera, const CameraAnimation& a, float frame) {
  CameraDescription at = camera;
  at.position = value_at(a.position, frame, camera.position);
  at.look_at = value_at(a.look_at, frame, camera.look_at);
  at.up = value_at(a.up, frame, camera.up);
  at.vertical_fov_degrees = value_at(a.vertical_fov_degrees, frame, camera.vertical_fov_degrees);
  at.aperture_radius = value_at(a.aperture_radius, frame, camera.aperture_radius);
  at.focus_distance = value_at(a.focus_distance, frame, camera.focus_distance);
  at.aperture_rotation_degrees =
      value_at(a.aperture_rotation_degrees, frame, camera.aperture_rotation_degrees);
  at.view_height = value_at(a.view_height, frame, camera.view_height);
  at.lens_shift = value_at(a.lens_shift, frame, camera.lens_shift);
  return at;
}

bool is_sound(const Animation& animation) {
  const CameraAnimation& c = animation.camera;
  return are_sound_tracks(c.position, c.look_at, c.up, c.vertical_fov_degrees, c.aperture_radius,
                          c.focus_distance, c.aperture_rotation_degrees, c.view_height, c.lens_shift) &&
         std::all_of(animation.lights.begin(), animation.lights.end(),
                     [](const LightAnimation& light) {
                       return are_sound_tracks(light.position, light.look_at, light.direction, light.color,
                                               light.angle_degrees, light.softness);
                     }) &&
         std::all_of(animation.instances.begin(), animation.instances.end(),
                     [](const InstanceMotion& motion) {
                       return std::all_of(motion.steps.begin(), motion.steps.end(), is_sound_step);
                     });
}

}  // namespace tessera::core
