// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace tessera::client {

// A scene of 150 x 100 pixels.
inline constexpr const char* kGlowingSphere = R"({
  "render": {"width": 150, "height": 100, "spp": 4},
  "camera": {"position": [0, 0, 4], "look_at": [0, 0, 0]},
  "materials": {"glow": {"type": "lambert", "albedo": 0.5, "emission": [2, 1, 0.5]}},
  "shapes": [{"type": "sphere", "radius": 1, "center": [0, 0, 0], "material": "glow"}]
})";

}  // namespace tessera::client
