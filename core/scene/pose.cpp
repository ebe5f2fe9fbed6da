// SPDX-License-Identifier: Apache-2.0
#include "core/scene/pose.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/geometry/moving_placement.hpp"
#include "core/scene/tables/camera_tables.hpp"
#include "core/scene/tables/light_tables.hpp"

namespace tessera::core {
namespace {

LightDescription light_at(const LightDescription& light, const LightAnimation& animation, float frame) {
  return std::visit(
      [&]<typename Light>(const Light& description) -> LightDescription {
        return tracked_values_at(kKeys<Light>, description, animation, frame);
      },
      light);
}

// Those of the interval at which the camera is checked: its ends, the keyframes in it, and some between.
std::set<float> frames_to_check(const CameraAnimation& camera, FrameInterval interval) {
  constexpr int kParts = 16;
  std::set<float> frames;
  for (int i = 0; i <= kParts; ++i) frames.insert(interval.at(static_cast<float>(i) / kParts));
  const auto add_keyframes = [&](const auto& track) {
    const std::vector<float>& all = track.frames;
    const auto first = std::upper_bound(all.begin(), all.end(), interval.begin);
    frames.insert(first, std::lower_bound(first, all.end(), interval.end));
  };
  visit_tracks(kKeys<CameraDescription>, camera, add_keyframes);
  return frames;
}

// The number of each shape among the instances of the scene.
std::vector<std::uint32_t> instance_numbers(const SceneDescription& scene) {
  std::vector<std::uint32_t> numbers;
  std::uint32_t next = 0;
  for (const ShapeDescription& shape : scene.shapes) {
    numbers.push_back(next);
    if (std::holds_alternative<InstanceDescription>(shape)) ++next;
  }
  return numbers;
}

}  // namespace

PoseMaker::PoseMaker(const SceneDescription& scene)
    : animation_(scene.animation),
      camera_(scene.camera),
      lights_(scene.lights),
      environment_(scene.environment) {
  if (animation_.changes_materials()) {
    materials_ = scene.materials;
    media_ = scene.media;
  }
  if (animation_.instances.empty()) return;
  const std::vector<std::uint32_t> numbers = instance_numbers(scene);
  for (const InstanceMotion& motion : animation_.instances) {
    const auto& instance = std::get<InstanceDescription>(scene.shapes[motion.shape]);
    const bool is_named = motion.shape < scene.shape_names.size() && !scene.shape_names[motion.shape].empty();
    moving_.push_back({numbers[motion.shape], placement_limits(scene, instance),
                       is_named ? scene.shape_names[motion.shape] : fmt::format("shapes[{}]", motion.shape)});
  }
}

Result<Pose> PoseMaker::at(std::int32_t frame) const {
  const auto time = static_cast<float>(frame);
  Pose pose{.camera = camera_at(time), .lights = lights_, .placements = {}};
  for (const LightAnimation& light : animation_.lights)
    pose.lights[light.light] = light_at(lights_[light.light], light, time);
  for (const InstanceMotion& motion : animation_.instances)
    pose.placements.push_back(transform_at(motion.steps, time));
  pose.materials = all_at(materials_, animation_.materials, time);
  pose.media = all_at(media_, animation_.media, time);
  if (environment_) pose.environment = values_at(*environment_, animation_.environment, time);
  if (auto ok = check(pose); !ok) return fail(ok.error().within(fmt::format("frame {}", frame)));
  if (auto ok = check_while_open(frame); !ok) return fail(ok.error());
  return pose;
}

FrameInterval PoseMaker::shutter(std::int32_t frame) const {
  const auto at = [frame](float offset) {
    return static_cast<float>(static_cast<double>(frame) + double{offset});
  };
  return {at(camera_.shutter_open), at(camera_.shutter_close)};
}

Status PoseMaker::check_while_open(std::int32_t frame) const {
  const FrameInterval open = shutter(frame);
  if (open.empty() && open.begin == static_cast<float>(frame)) return {};
  if (auto ok = check_moving(open); !ok)
    return fail(ok.error().within(fmt::format("frame {}, while the shutter is open", frame)));
  return {};
}

// At the frames at which motions are bounded, and the camera at as many and at its keyframes.
Status PoseMaker::check_moving(FrameInterval shutter) const {
  if (is_animated(animation_.camera))
    for (const float frame : frames_to_check(animation_.camera, shutter))
      if (auto ok = validate_camera(camera_at(frame)); !ok) return ok;
  for (std::size_t i = 0; i < moving_.size(); ++i) {
    const std::vector<MotionStep>& steps = animation_.instances[i].steps;
    float determinant_before = 0;
    for (const float frame : frames_to_check(steps, shutter)) {
      const Transform placement = transform_at(steps, frame);
      if (auto ok = validate_placement(placement, moving_[i].limits); !ok)
        return fail(ok.error().within(moving_[i].name));
      const float determinant = placement.determinant();
      if (determinant * determinant_before < 0)
        return fail(ErrorCode::kInvalidArgument,
                    moving_[i].name + ": the transform flattens the object on its way to a reflection");
      determinant_before = determinant;
    }
  }
  return {};
}

Status PoseMaker::check(const Pose& pose) const {
  if (auto ok = validate_camera(pose.camera); !ok) return ok;
  if (auto ok = validate_lights(pose.lights); !ok) return ok;
  for (std::size_t i = 0; i < moving_.size(); ++i) {
    if (auto ok = validate_placement(pose.placements[i], moving_[i].limits); !ok)
      return fail(ok.error().within(moving_[i].name));
  }
  return {};
}

bool frames_differ(const SceneDescription& scene) {
  return is_animated(scene.animation) && scene.contents.animations.empty();
}

Status validate_frames(const SceneDescription& scene, std::span<const std::int32_t> frames) {
  if (!is_animated(scene.animation)) return {};
  const PoseMaker maker(scene);
  for (const std::int32_t frame : frames)
    if (auto pose = maker.at(frame); !pose) return fail(pose.error());
  return {};
}

}  // namespace tessera::core
