// SPDX-License-Identifier: Apache-2.0
// Writes curves as a binary PLY file (core/scene/loader/curve_file.hpp). Stateless; thread-safe.
#pragma once

#include <string>

#include "core/geometry/curves.hpp"

namespace tessera::core {

// A radius for each point is part of the file; a single one for all is not.
std::string write_curve_file(const CurveStrands& strands);

}  // namespace tessera::core
