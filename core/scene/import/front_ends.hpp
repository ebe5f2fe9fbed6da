// SPDX-License-Identifier: Apache-2.0
// The readers of scene files, one for each format, and the choice among them. Each converts a file, and the
// files that it names, into a SceneDescription. The arguments and errors are those of load_scene()
// (core/scene/loader/loader.hpp). Thread-safe.
#pragma once

#include <string>

#include "core/base/error.hpp"
#include "core/scene/description.hpp"
#include "core/scene/loader/asset_source.hpp"
#include "core/scene/loader/scene_limits.hpp"

namespace tessera::core {

// The type of all of them.
using ReadScene = Result<SceneDescription>(AssetSource& assets, const std::string& scene_path,
                                           const std::string& display_path, const SceneLimits& limits);

ReadScene read_gltf_scene;  // glTF 2.0: .gltf and .glb (core/scene/gltf)
ReadScene read_pbrt_scene;  // pbrt-v4: .pbrt (core/scene/pbrt)
// Mitsuba 3: .xml (core/scene/mitsuba). Parameters that a command line replaces stand in the scene's text as
// <default> elements before all others (with_overrides()), since the first value of a name counts.
ReadScene read_mitsuba_scene;
ReadScene read_mesh_scene;  // a bare mesh: .obj, .ply, .ply.gz and .stl (core/scene/import)

}  // namespace tessera::core
