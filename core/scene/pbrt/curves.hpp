// SPDX-License-Identifier: Apache-2.0
// The shape "curve" (pbrt-v4 file format, "Shapes"). Stateless; thread-safe.
#pragma once

#include <optional>

#include "core/geometry/curves.hpp"
#include "core/scene/pbrt/parameters.hpp"
#include "core/scene/pbrt/report.hpp"

namespace tessera::core::pbrt {

// The curve in its own space: each segment is a cubic Bezier curve of its own, as it has texture coordinates
// of its own, and its radius is linear. nullopt, with a warning, if there is none.
std::optional<CurveStrands> read_curve(const Parameters& p, const Report& report);

}  // namespace tessera::core::pbrt
