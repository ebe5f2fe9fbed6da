// SPDX-License-Identifier: Apache-2.0
#include "core/scene/animation.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/base/overloaded.hpp"
#include "core/scene/tables/camera_tables.hpp"

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

bool is_sound_camera(const CameraAnimation& camera) {
  bool is_sound = true;
  visit_tracks(kKeys<CameraDescription>, camera,
               [&](const auto& track) { is_sound = is_sound && is_sound_track(track); });
  return is_sound;
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

bool is_animated(const CameraAnimation& camera) {
  bool is_animated = false;
  visit_tracks(kKeys<CameraDescription>, camera,
               [&](const auto& track) { is_animated = is_animated || !track.empty(); });
  return is_animated;
}

CameraDescription camera_at(const CameraDescription& camera, const CameraAnimation& animation, float frame) {
  return tracked_values_at(kKeys<CameraDescription>, camera, animation, frame);
}

bool is_sound(const Animation& animation) {
  return is_sound_camera(animation.camera) &&
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
