// SPDX-License-Identifier: Apache-2.0
// The placement of an instance that moves while the shutter is open. Immutable.
#pragma once

#include <utility>
#include <vector>

#include "core/geometry/aabb.hpp"
#include "core/geometry/placement.hpp"
#include "core/math/motion.hpp"

namespace tessera::core {

class MovingPlacement {
 public:
  // The placements at all of frames_to_check() must be possible: see Placement::can_place().
  MovingPlacement(std::vector<MotionStep> steps, FrameInterval shutter)
      : steps_(std::move(steps)), shutter_(shutter) {}

  // At a time from 0, when the shutter opens, to 1, when it closes: the placement of a still instance at that
  // frame, to the bit.
  Placement at(float time) const { return Placement(transform_at(steps_, shutter_.at(time))); }

  // Bounds of points of the boxes at all times, including the error of intersection. Between two frames of
  // frames_to_check(), points stray from their chords by at most an eighth of the greatest second derivative
  // times the square of the time.
  Aabb bounds(const std::vector<Aabb>& boxes) const;

 private:
  std::vector<MotionStep> steps_;
  FrameInterval shutter_;
};

// Whether an instance is at different places during the interval.
bool moves(const std::vector<MotionStep>& steps, FrameInterval interval);

// The frames at which a motion is looked at to bound it: the ends of the interval, the keyframes in it, and
// some between these if points do not move along straight lines.
std::vector<float> frames_to_check(const std::vector<MotionStep>& steps, FrameInterval interval);

}  // namespace tessera::core
