// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/moving_placement.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/rounding.hpp"

namespace tessera::core {
namespace {

// The parts into which the time between two keyframes is divided: a quarter turn then leaves its chords by a
// thousandth of the radius.
constexpr int kParts = 16;

// Bounds the rounding errors of transforms, which are computed in float, relative to distances from the
// origin; and those of angles of up to kMaxTurnDegrees.
constexpr double kRoundingOfMotion = 1e-5;

double farthest_from_origin(const Aabb& box) {
  return static_cast<double>(length(Vec3d(max(abs(box.lower), abs(box.upper)))));
}

// Beyond everything that a scene may hold.
constexpr double kFarthest = 1e16;

// `by` may be NaN: bounds of motions with far keyframes may overflow.
void grow(Aabb& box, double by) {
  if (!(by < kFarthest)) by = kFarthest;
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = next_float_down(static_cast<float>(double{box.lower[axis]} - by));
    box.upper[axis] = next_float_up(static_cast<float>(double{box.upper[axis]} + by));
  }
}

}  // namespace

Aabb MovingPlacement::bounds(const std::vector<Aabb>& boxes) const {
  const std::vector<float> frames = frames_to_check(steps_, shutter_);
  double longest = 0;
  for (std::size_t i = 1; i < frames.size(); ++i)
    longest = std::max(longest, double{frames[i]} - double{frames[i - 1]});
  std::vector<Aabb> swept(boxes.size());
  for (const float frame : frames) {
    const Placement placement(transform_at(steps_, frame));
    for (std::size_t i = 0; i < boxes.size(); ++i) swept[i].include(placement.bounds(boxes[i]));
  }
  Aabb all;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const PointMotion motion = bounds_of_motion(steps_, farthest_from_origin(boxes[i]), shutter_);
    grow(swept[i], motion.acceleration * longest * longest / 8 + kRoundingOfMotion * motion.radius);
    all.include(swept[i]);
  }
  return all;
}

bool moves(const std::vector<MotionStep>& steps, FrameInterval interval) {
  return !interval.empty() && bounds_of_motion(steps, 1, interval).speed != 0;  // NaN after an overflow
}

std::vector<float> frames_to_check(const std::vector<MotionStep>& steps, FrameInterval interval) {
  std::vector<float> bends{interval.begin};
  for (const float frame : keyframes_of(steps))
    if (frame > interval.begin && frame < interval.end) bends.push_back(frame);
  bends.push_back(interval.end);
  const int parts = bounds_of_motion(steps, 1, interval).acceleration == 0 ? 1 : kParts;
  std::vector<float> frames{interval.begin};
  for (std::size_t i = 1; i < bends.size(); ++i)
    for (int part = 1; part <= parts; ++part)
      frames.push_back(
          FrameInterval{bends[i - 1], bends[i]}.at(static_cast<float>(part) / static_cast<float>(parts)));
  return frames;
}

}  // namespace tessera::core
