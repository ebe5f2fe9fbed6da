// SPDX-License-Identifier: Apache-2.0
// Reads the XML files of a Mitsuba scene, versions 0.x to 3. Entities are not expanded, but for those that
// XML predefines: a document type is skipped. Not thread-safe.
#pragma once

#include "core/base/error.hpp"
#include "core/scene/import/scene_builder.hpp"
#include "core/scene/mitsuba/scene_graph.hpp"

namespace tessera::core::mitsuba {

// The scene file of `builder` with the files that it includes. References are resolved, without cycles, and
// no chain of properties and references is longer than kMaxNesting. What cannot be read is left out with a
// warning. Errors are "FILE:LINE: WHAT": malformed XML, undefined parameters, missing includes, cycles.
Result<SceneGraph> read_scene_graph(SceneBuilder& builder);

}  // namespace tessera::core::mitsuba
