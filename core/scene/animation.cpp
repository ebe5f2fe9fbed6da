// SPDX-License-Identifier: Apache-2.0
#include "core/scene/animation.hpp"

#include <algorithm>
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

bool is_number(float value) {
  return std::isfinite(value);
}
bool is_number(Rgb value) {
  return is_finite(value);
}

bool are_sound_parameters(const ParameterTracks& tracks) {
  const auto are_sound = [](const auto& keyed) {
    return std::all_of(keyed.begin(), keyed.end(), [](const auto& each) {
      const auto& values = each.track.values;
      return is_sound_track(each.track) && !each.track.empty() &&
             std::all_of(values.begin(), values.end(), [](const auto& value) { return is_number(value); });
    });
  };
  return are_sound(tracks.numbers) && are_sound(tracks.colors);
}

bool are_sound_parameters(const std::vector<IndexedTracks>& all) {
  return std::all_of(all.begin(), all.end(),
                     [](const IndexedTracks& each) { return are_sound_parameters(each.tracks); });
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

}  // namespace

bool is_animated(const CameraAnimation& c) {
  return !(c.position.empty() && c.look_at.empty() && c.up.empty() && c.vertical_fov_degrees.empty() &&
           c.aperture_radius.empty() && c.focus_distance.empty() && c.aperture_rotation_degrees.empty() &&
           c.view_height.empty() && c.lens_shift.empty());
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
                     }) &&
         are_sound_parameters(animation.materials) && are_sound_parameters(animation.media) &&
         are_sound_parameters(animation.environment);
}

}  // namespace tessera::core
