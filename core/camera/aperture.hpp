// SPDX-License-Identifier: Apache-2.0
// The opening of a thin lens: a disk, or a regular polygon like that of a camera's blades. Immutable.
#pragma once

#include <vector>

#include "core/math/vec3.hpp"

namespace tessera::core {

class Aperture {
 public:
  Aperture() = default;
  // A disk where `blades` is 0; else a regular polygon of so many corners (3 or more) on the circle of
  // `radius`. The first corner lies in the direction of +y, turned by `rotation_degrees` towards -x.
  Aperture(float radius, int blades, float rotation_degrees);

  bool is_pinhole() const { return radius_ == 0; }

  // Uniform over the area, and continuous: neighbours in the square stay neighbours. `u` in [0, 1)^2.
  Vec2 sample(Vec2 u) const;

 private:
  float radius_ = 0;
  std::vector<Vec2> corners_;  // counter-clockwise, the first once more at the end; none for a disk
};

}  // namespace tessera::core
