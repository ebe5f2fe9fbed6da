// SPDX-License-Identifier: Apache-2.0
// What of a glTF file is rendered: the extension TESSERA_selection (core/scene/import/selection.hpp), or the
// file's defaults. Functions throw Refusals: if there is no such thing, they say what there is.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/scene/gltf/document.hpp"

namespace tessera::core::gltf {

struct Selection {
  explicit Selection(const Document& document);

  std::string camera;          // a name or a number; empty: the first
  std::optional<Value> scene;  // nullopt: the file's default
  std::optional<std::size_t> variant;
  std::vector<Value> animations{};  // played together; empty: there is none, or none is wanted
  bool names_animations = false;    // they were chosen, and are no default
  std::optional<float> seconds;     // nullopt: none was chosen, which means the beginning
  float shutter_seconds = 0;        // how long the shutter is open from then on

  // The moments at which nodes are looked at, in seconds after the chosen time: 0, and some until the shutter
  // closes, between which they move evenly. They are frames of the scene.
  std::vector<float> moments() const;
};

// Which of the cameras is chosen.
std::size_t selected_camera(const Selection& selection, const std::vector<std::string>& names);

}  // namespace tessera::core::gltf
