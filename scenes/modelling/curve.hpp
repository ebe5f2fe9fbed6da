// SPDX-License-Identifier: Apache-2.0
// Smooth curves through given points.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/math/vec3.hpp"

namespace tessera::modelling {

// The uniform Catmull-Rom spline (Catmull and Rom 1974) through `points`, of which there are at least two, at
// t in [0, 1]: points[i] at t = i / (count - 1). The end points count twice.
template <typename Point>
Point spline(const std::vector<Point>& points, float t) {
  const auto last = static_cast<int>(points.size()) - 1;
  const float scaled = std::clamp(t, 0.0f, 1.0f) * static_cast<float>(last);
  const int i = std::min(static_cast<int>(scaled), last - 1);
  const float s = scaled - static_cast<float>(i);
  const auto at = [&](int k) { return points[static_cast<std::size_t>(std::clamp(k, 0, last))]; };
  const Point a = at(i - 1), b = at(i), c = at(i + 1), d = at(i + 2);
  const Point linear = c - a;
  const Point square = a * 2 - b * 5 + c * 4 - d;
  const Point cube = (b - c) * 3 + d - a;
  return b + (linear * s + square * (s * s) + cube * (s * s * s)) * 0.5f;
}

// A curve in the half plane of radius (x) and height (y), sampled evenly by its length.
class Profile {
 public:
  // Through `points`; radii stay at or above 0.
  explicit Profile(const std::vector<core::Vec2>& points);

  // t in [0, 1] is the fraction of the length. at(0) and at(1) are the first and the last point exactly.
  core::Vec2 at(float t) const;
  // The fraction of the length at which the curve comes nearest to points[index].
  float fraction_of_point(std::size_t index) const { return point_fractions_[index]; }
  float length() const { return lengths_.back(); }

 private:
  std::vector<core::Vec2> samples_;
  std::vector<float> lengths_;  // from the start to each sample
  std::vector<float> point_fractions_;
};

}  // namespace tessera::modelling
