// SPDX-License-Identifier: Apache-2.0
#include "core/scene/pose.hpp"

#include <fmt/format.h>

#include "core/base/overloaded.hpp"

namespace tessera::core {
namespace {

LightDescription light_at(const LightDescription& light, const LightAnimation& a, float frame) {
  return std::visit(Overloaded{[&](PointLightDescription d) -> LightDescription {
                                 d.position = value_at(a.position, frame, d.position);
                                 d.intensity = value_at(a.color, frame, d.intensity);
                                 return d;
                               },
                               [&](SpotLightDescription d) -> LightDescription {
                                 d.position = value_at(a.position, frame, d.position);
                                 d.look_at = value_at(a.look_at, frame, d.look_at);
                                 d.intensity = value_at(a.color, frame, d.intensity);
                                 d.angle_degrees = value_at(a.angle_degrees, frame, d.angle_degrees);
                                 d.softness = value_at(a.softness, frame, d.softness);
                                 return d;
                               },
                               [&](DirectionalLightDescription d) -> LightDescription {
                                 d.direction = value_at(a.direction, frame, d.direction);
                                 d.irradiance = value_at(a.color, frame, d.irradiance);
                                 return d;
                               }},
                    light);
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
    : animation_(scene.animation), camera_(scene.camera), lights_(scene.lights) {
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
  Pose pose{camera_at(camera_, animation_.camera, time), lights_, {}};
  for (const LightAnimation& light : animation_.lights)
    pose.lights[light.light] = light_at(lights_[light.light], light, time);
  for (const InstanceMotion& motion : animation_.instances)
    pose.placements.push_back(transform_at(motion.steps, time));
  if (auto ok = check(pose); !ok) return fail(ok.error().within(fmt::format("frame {}", frame)));
  return pose;
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

Status validate_frames(const SceneDescription& scene, std::span<const std::int32_t> frames) {
  if (!is_animated(scene.animation)) return {};
  const PoseMaker maker(scene);
  for (const std::int32_t frame : frames)
    if (auto pose = maker.at(frame); !pose) return fail(pose.error());
  return {};
}

}  // namespace tessera::core
