// SPDX-License-Identifier: Apache-2.0
// Reads a scene file and the files it names. The ending of its name chooses the format, else its content:
// our own (JSON with comments; scenes/scene.schema.json describes it), or that of another program
// (core/scene/import/front_ends.hpp).
//
// In our own format every mistake is an error that says file, line, field, what is wrong and what would be
// right, e.g. "scene.json:14: materials.stone.albedo: must be between 0 and 1, got 3". Unknown keys are
// mistakes. Files of other programs are read leniently: missing, odd or unsupported content is substituted
// and reported in the description's warnings.
#pragma once

#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/scene/description.hpp"
#include "core/scene/loader/asset_source.hpp"
#include "core/scene/loader/parameter_override.hpp"
#include "core/scene/loader/scene_limits.hpp"

namespace tessera::core {

// `scene_path` is the scene's name in `assets`; other paths are relative to it and resolved by `assets`.
// `display_path` is the scene file's name in messages. Returns RESOURCE_EXHAUSTED for a scene that exceeds
// the limits or the memory.
Result<SceneDescription> load_scene(AssetSource& assets, const std::string& scene_path,
                                    const std::string& display_path, const SceneLimits& limits = {});

// Loads a local scene file, with these parameters replaced, and the files beside it.
Result<SceneDescription> load_scene_file(const std::string& path,
                                         const std::vector<ParameterOverride>& overrides = {},
                                         const SceneLimits& limits = {});

}  // namespace tessera::core
