// SPDX-License-Identifier: Apache-2.0
// What a file of another program holds of which only one is rendered, for `tessera info` and for those who
// choose. Plain data.
#pragma once

#include <string>
#include <vector>

namespace tessera::core {

struct SceneContents {
  struct Animation {
    std::string name;
    float seconds = 0;  // the time of its last keyframe
  };

  // The names, in the order of their numbers, which begin at 0; empty for one without a name.
  std::vector<std::string> cameras, scenes, variants;
  std::vector<Animation> animations;
};

}  // namespace tessera::core
