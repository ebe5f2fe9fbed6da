// SPDX-License-Identifier: Apache-2.0
// A double cone: the lines through its apex that differ from its axis by at most an angle.
#pragma once

#include "core/math/vec3.hpp"

namespace tessera::core {

struct DoubleCone {
  Vec3 apex, axis;     // the axis has unit length
  float cosine, sine;  // of the angle between the axis and the outermost lines
};

}  // namespace tessera::core
