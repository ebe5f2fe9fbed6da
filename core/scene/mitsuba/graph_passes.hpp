// SPDX-License-Identifier: Apache-2.0
// What is done with the objects of a Mitsuba scene between their file and their conversion. Stateless.
#pragma once

#include "core/scene/mitsuba/scene_graph.hpp"

namespace tessera::core::mitsuba {

// A node more than kMaxNesting references below the scene, or in a circle of references; null if there is
// none.
const Node* too_deep(const SceneGraph& graph);

// What Mitsuba changes of files before version 2, besides the names.
void upgrade_node(Node& node);

}  // namespace tessera::core::mitsuba
