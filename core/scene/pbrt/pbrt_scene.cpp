// SPDX-License-Identifier: Apache-2.0
// Reads scenes of pbrt-v4 (Pharr et al. 2023), and the commonest directives of pbrt-v3.
#include "core/scene/import/front_ends.hpp"
#include "core/scene/import/nested_instances.hpp"
#include "core/scene/import/scene_builder.hpp"
#include "core/scene/pbrt/interpreter.hpp"

namespace tessera::core {

// A scene without lights is black, as in pbrt.
Result<SceneDescription> read_pbrt_scene(AssetSource& assets, const std::string& scene_path,
                                         const std::string& display_path, const SceneLimits& limits) {
  SceneBuilder builder(assets, scene_path, display_path, limits);
  pbrt::Interpreter interpreter(builder);
  if (auto read = interpreter.run(); !read) return fail(read.error());
  if (auto flat = flatten_instances(builder.scene()); !flat) return fail(flat.error().within(display_path));
  SceneDefaults defaults;
  defaults.studio_light = false;
  return builder.finish(defaults);
}

}  // namespace tessera::core
