// SPDX-License-Identifier: Apache-2.0
// Animated transforms: steps whose parameters have keyframes. Plain data and pure functions.
#pragma once

#include <set>
#include <variant>
#include <vector>

#include "core/math/quaternion.hpp"
#include "core/math/track.hpp"
#include "core/math/transform.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core {

// The largest angle of a keyframe: larger ones would lose the accuracy of sine.
inline constexpr float kMaxTurnDegrees = 3600;

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

// The transform at a frame; the steps are applied in their order. A single one keeps its bits, as negative
// zeros.
Transform transform_at(const std::vector<MotionStep>& steps, float frame);

// All frames at which a parameter has a keyframe.
std::set<float> keyframes_of(const std::vector<MotionStep>& steps);

// Bounds on a moving point: its distance from the origin, and the lengths of its first and second derivative
// between two keyframes, per frame.
struct PointMotion {
  double radius = 0, speed = 0, acceleration = 0;
};
// Those of any point that is at most `radius` from the origin before the steps, at the frames of `interval`.
// The second derivative bounds how far a path strays from its chord.
PointMotion bounds_of_motion(const std::vector<MotionStep>& steps, double radius, FrameInterval interval);

}  // namespace tessera::core
