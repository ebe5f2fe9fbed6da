// SPDX-License-Identifier: Apache-2.0
// Whether the strategies of path tracing, which differ in noise alone, agree on a scene's expectation, and
// whether two ways to describe a scene do.
#pragma once

#include "core/scene/description.hpp"

namespace tessera::test {

// Adds a failure to the running test for each region of the image in which two strategies differ by more
// than chance allows.
void expect_strategies_agree(core::SceneDescription description);

// The same of two descriptions of one scene.
void expect_scenes_agree(core::SceneDescription a, core::SceneDescription b);

}  // namespace tessera::test
