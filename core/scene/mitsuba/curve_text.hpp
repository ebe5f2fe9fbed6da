// SPDX-License-Identifier: Apache-2.0
// The text files of Mitsuba's curves: a control point "x y z radius" in each line, and an empty line between
// curves. Stateless; thread-safe.
#pragma once

#include <string_view>

#include "core/base/error.hpp"
#include "core/geometry/curves.hpp"

namespace tessera::core::mitsuba {

// INVALID_ARGUMENT for a file without curves, or with a line that is no control point. Errors complete a
// sentence that begins with the file's name.
Result<CurveStrands> read_curve_text(std::string_view text, CurveBasis basis);

}  // namespace tessera::core::mitsuba
