// Whether the strategies of path tracing, which differ in noise alone, agree on a scene's expectation.
#pragma once

#include "core/scene/description.hpp"

namespace tessera::test {

// Adds a failure to the running test for each region of the picture in which two strategies differ by more
// than chance allows.
void expect_strategies_agree(core::SceneDescription description);

}  // namespace tessera::test
