// SPDX-License-Identifier: Apache-2.0
// Curves in a PLY file: the element "vertex" with the control points x, y, z and, optionally, the property
// "radius"; the element "curve" with the property "points", the number of control points of each curve; and
// for ribbons the element "normal" with nx, ny, nz. Stateless; thread-safe.
#pragma once

#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "core/geometry/curves.hpp"

namespace tessera::core {

// Everything but basis and shape; `radii` is empty if the file has none. Counts may be any. Also ascii and
// gzip. Errors are "NAME: what", with `name` the file's name in messages: INVALID_ARGUMENT. Memory is taken
// only for what the file is long enough to hold.
Result<CurveStrands> read_curve_file(std::string_view bytes, const std::string& name);

}  // namespace tessera::core
