// SPDX-License-Identifier: Apache-2.0
// How an image was made, as texts in the header of its OpenEXR file: enough to render the same
// bytes from the scene. It names nobody, no time and no machine. Pure functions.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/error.hpp"
#include "core/scene/settings.hpp"

namespace tessera::core {

struct RenderRecord {
  std::string version;      // of Tessera
  std::string fingerprint;  // its determinism fingerprint
  std::string scene;        // the digest of the scene at the frame, as text
  RenderSettings settings;
  std::int32_t frame = 0;
  bool complete = true;  // or some pixels have fewer samples than the settings ask for
};

using TextAttributes = std::vector<std::pair<std::string, std::string>>;

// "tessera/version", "tessera/fingerprint", "tessera/scene" and "tessera/settings", in which the settings are
// an object in JSON.
TextAttributes attributes_of(const RenderRecord& record);

// The settings as that object, without spaces: {"width":640,...,"complete":true}.
std::string settings_text(const RenderRecord& record);

}  // namespace tessera::core
