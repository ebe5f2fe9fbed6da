// SPDX-License-Identifier: Apache-2.0
// Colour profiles in image files, by name: they are not applied, and so must be told. Stateless; thread-safe.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace tessera::core {

// The profile that is embedded in a PNG, JPEG, TIFF or WebP file and is not sRGB: its description, as in
// "Adobe RGB (1998)", or what a PNG file says without a profile: "gamma 1.0". Printable. nullopt if there is
// none, or it cannot be read.
std::optional<std::string> foreign_color_profile(std::string_view bytes);

}  // namespace tessera::core
