// SPDX-License-Identifier: Apache-2.0
// The choice of a camera, scene, variant, animation and time, as the text of a scene file has it
// (with_overrides() writes it), and the search for what is chosen. Stateless; thread-safe.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "core/base/error.hpp"

namespace tessera::core {

// What can be chosen: members of the extension, and ends of the names of parameters.
inline constexpr std::string_view kSelectCamera = "camera", kSelectScene = "scene",
                                  kSelectVariant = "variant", kSelectAnimation = "animation",
                                  kSelectTime = "time";
// The extension of a glTF file's root, whose members are strings and, for the time, a number of seconds.
inline constexpr std::string_view kGltfSelection = "TESSERA_selection";
// A Mitsuba scene's parameter of the camera is "tessera_camera".
inline constexpr std::string_view kMitsubaSelection = "tessera_";

// The index of the first entry of this name; else the name is read as an index. INVALID_ARGUMENT lists what
// there is; `what` is "camera".
Result<std::size_t> find_selected(std::string_view what, std::string_view wanted,
                                  std::span<const std::string> names);

}  // namespace tessera::core
