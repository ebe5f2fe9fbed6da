// SPDX-License-Identifier: Apache-2.0
// The aperture of a thin lens: a disk or a regular polygon (the blades of a diaphragm). Immutable.
#pragma once

#include <vector>

#include "core/math/vec3.hpp"

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

  // A uniform point on the area; the map is continuous. `u` is in [0, 1)^2.
  Vec2 sample(Vec2 u) const;

 private:
  float radius_ = 0;
  std::vector<Vec2> corners_;  // counter-clockwise, the first repeated at the end; empty for a disk
};

}  // namespace tessera::core
