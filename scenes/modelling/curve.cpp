// SPDX-License-Identifier: Apache-2.0
#include "scenes/modelling/curve.hpp"

#include <cmath>

namespace tessera::modelling {

using core::Vec2;

Profile::Profile(const std::vector<Vec2>& points) {
  constexpr std::size_t kSamplesPerSpan = 64;
  const std::size_t spans = points.size() - 1, count = spans * kSamplesPerSpan;
  float length = 0;
  for (std::size_t i = 0; i <= count; ++i) {
    const Vec2 p = spline(points, static_cast<float>(i) / static_cast<float>(count));
    samples_.push_back({std::max(p.x, 0.0f), p.y});
    if (i > 0) {
      const Vec2 step = samples_[i] - samples_[i - 1];
      length += std::sqrt(step.x * step.x + step.y * step.y);
    }
    lengths_.push_back(length);
  }
  samples_.front() = points.front();
  samples_.back() = points.back();
  for (std::size_t i = 0; i <= spans; ++i) point_fractions_.push_back(lengths_[i * kSamplesPerSpan] / length);
}

Vec2 Profile::at(float t) const {
  if (t <= 0) return samples_.front();
  if (t >= 1) return samples_.back();
  const float target = t * length();
  const auto above = std::upper_bound(lengths_.begin() + 1, lengths_.end() - 1, target);
  const auto i = static_cast<std::size_t>(above - lengths_.begin());
  const float span = lengths_[i] - lengths_[i - 1];
  const float s = span > 0 ? (target - lengths_[i - 1]) / span : 0;
  return samples_[i - 1] + (samples_[i] - samples_[i - 1]) * s;
}

}  // namespace tessera::modelling
