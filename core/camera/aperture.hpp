// SPDX-License-Identifier: Apache-2.0
// The aperture of a thin lens: a disk or a regular polygon (the blades of a diaphragm). Immutable.
#pragma once

#include <vector>

#include "core/math/simd.hpp"
#include "core/math/vec3.hpp"
#include "core/sampling/warp.hpp"

namespace tessera::core {

class Aperture {
 public:
  Aperture() = default;
  // A disk if `blades` is 0; else a regular polygon with `blades` corners (at least 3) on the circle of
  // `radius`. The first corner lies in the direction of +y, rotated by `rotation_degrees` towards -x.
  Aperture(float radius, int blades, float rotation_degrees);

  bool is_pinhole() const { return radius_ == 0; }
  // Of the circle around it.
  float radius() const { return radius_; }
  float area() const;
  bool contains(Vec2 point) const;

  // A uniform point on the area; the map is continuous. `u` is in [0, 1)^2. T is float or FloatN.
  template <typename T = float>
  Vec2Of<T> sample(Vec2Of<T> u) const {
    if (corners_.empty()) return sampling::sample_disk(u) * T(radius_);
    return sample_polygon(u);
  }

 private:
  Vec2 sample_polygon(Vec2 u) const;
  Vec2Of<FloatN> sample_polygon(Vec2Of<FloatN> u) const;

  float radius_ = 0;
  std::vector<Vec2> corners_;  // counter-clockwise, the first repeated at the end; empty for a disk
};

}  // namespace tessera::core
