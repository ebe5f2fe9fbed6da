// SPDX-License-Identifier: Apache-2.0
// Finds the files that a scene names.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/scene/import/scene_builder.hpp"
#include "core/scene/pbrt/report.hpp"
#include "core/scene/pbrt/tokenizer.hpp"

namespace tessera::core::pbrt {

// The path of the file that `place` calls `written`, with its escapes: names are relative to the folder of
// the scene file, or else to that of the included file. If it has no file, '\' separates folders.
inline std::optional<std::string> find_file(SceneBuilder& builder, const Place& place,
                                            const std::string& written) {
  const std::vector<std::string> beside{builder.scene_path(), *place.file};
  const std::string name = without_escapes(written);
  auto path = builder.find(name, beside, file_place(place));
  return path || name == written ? path : builder.find(written, beside, file_place(place));
}

}  // namespace tessera::core::pbrt
