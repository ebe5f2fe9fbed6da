// SPDX-License-Identifier: Apache-2.0
// The parameters of a scene that change from frame to frame.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/scene/description.hpp"
#include "core/scene/validation.hpp"

namespace tessera::core {

// The values at one frame.
struct Pose {
  CameraDescription camera;
  std::vector<LightDescription> lights;
  std::vector<Transform> placements;  // of Animation::instances
  // All of the scene's, if Animation::changes_materials().
  std::vector<Material> materials{};
  std::vector<MediumDescription> media{};
  std::optional<EnvironmentDescription> environment{};
};

// What is needed to place an instance anew and to validate its placement.
struct MovingInstance {
  std::uint32_t number = 0;  // among the instances of the scene
  PlacementLimits limits;
  std::string name;  // of the shape, for error messages
};

// The rest of what a pose is made of. It does not change.
class PoseMaker {
 public:
  PoseMaker() = default;
  // `scene` must be valid.
  explicit PoseMaker(const SceneDescription& scene);

  const Animation& animation() const { return animation_; }
  const std::vector<MovingInstance>& moving() const { return moving_; }

  // INVALID_ARGUMENT if the scene cannot be rendered at the frame: the error names the frame and the
  // parameter.
  Result<Pose> at(std::int32_t frame) const;

  // When the shutter is open for an image of the frame. If it takes no time, the interval is empty, and what
  // would move is shown at its beginning.
  FrameInterval shutter(std::int32_t frame) const;
  // At any frame, also between two images.
  CameraDescription camera_at(float frame) const {
    return core::camera_at(camera_, animation_.camera, frame);
  }
  // Whether what moves while the shutter is open can be rendered; an error as from at().
  Status check_while_open(std::int32_t frame) const;

 private:
  Status check(const Pose& pose) const;
  Status check_moving(FrameInterval shutter) const;

  Animation animation_;
  CameraDescription camera_;
  std::vector<LightDescription> lights_;
  std::vector<Material> materials_;  // as Pose::materials
  std::vector<MediumDescription> media_;
  std::optional<EnvironmentDescription> environment_;
  std::vector<MovingInstance> moving_;  // in the order of Animation::instances
};

// Whether a valid scene can be rendered at all of these frames, with the errors of PoseMaker::at().
Status validate_frames(const SceneDescription& scene, std::span<const std::int32_t> frames);

// Whether frames may differ: the scene has keyframes. Those of a glTF file describe one opening of the
// shutter.
bool frames_differ(const SceneDescription& scene);

}  // namespace tessera::core
