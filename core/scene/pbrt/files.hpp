// SPDX-License-Identifier: Apache-2.0
// Finds the files that a scene names.
#pragma once

#include <optional>
#include <string>

#include "core/scene/import/scene_builder.hpp"
#include "core/scene/pbrt/parameters.hpp"

namespace tessera::core::pbrt {

// The path of the file that `place` calls `written`: names are relative to the folder of the scene file, or
// else to that of the included file.
inline std::optional<std::string> find_file(SceneBuilder& builder, const Place& place,
                                            const std::string& written) {
  if (auto path = builder.find(written, builder.scene_path())) return path;
  return builder.find(written, *place.file);
}

}  // namespace tessera::core::pbrt
