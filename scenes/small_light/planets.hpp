// SPDX-License-Identifier: Apache-2.0
// Marbles painted like planets, a ring for one of them, and the chart on which they stand. Stateless; the
// same bytes on every machine.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/image/image.hpp"
#include "core/scene/description.hpp"

namespace tessera::small_light {

struct Painting {
  std::string name;
  std::function<core::Image()> paint;
};

// For spheres: longitude to the right, latitude upwards. "chart" is for a square of 16 by 16, the sun in the
// middle.
const std::vector<Painting>& paintings();

// A flat ring around a globe of radius 1, in the plane y = 0.
core::MeshDescription ring_mesh();

}  // namespace tessera::small_light
