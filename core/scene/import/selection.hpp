// SPDX-License-Identifier: Apache-2.0
// The choice of a camera, scene, variant, animation, time and shutter, as the text of a scene file has it
// (with_overrides() writes it), and the search for what is chosen. Stateless; thread-safe.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"

namespace tessera::core {

// What can be chosen: members of the extension, and ends of the names of parameters.
inline constexpr std::string_view kSelectCamera = "camera", kSelectScene = "scene",
                                  kSelectVariant = "variant", kSelectAnimation = "animation",
                                  kSelectTime = "time", kSelectShutter = "shutter";
// Instead of the name of an animation: none, or all of them together.
inline constexpr std::string_view kSelectNone = "none", kSelectAll = "all";
// Beside them: the names of the parameters that a command line replaces, one a line.
inline constexpr std::string_view kReplacedParameters = "parameters";
// The extension of a glTF file's root, whose members are strings and, for time and shutter, numbers of
// seconds.
inline constexpr std::string_view kGltfSelection = "TESSERA_selection";
// A Mitsuba scene's parameter of the camera is "tessera_camera".
inline constexpr std::string_view kMitsubaSelection = "tessera_";

// INVALID_ARGUMENT for a parameter that a command line replaces, and that nothing in the scene uses. `used`
// are those that may have been meant.
Error unused_parameter(std::string_view name, const std::vector<std::string_view>& used);

// The index of the first entry of this name; else the name is read as an index. INVALID_ARGUMENT lists what
// there is; `what` is "camera".
Result<std::size_t> find_selected(std::string_view what, std::string_view wanted,
                                  std::span<const std::string> names);

}  // namespace tessera::core
