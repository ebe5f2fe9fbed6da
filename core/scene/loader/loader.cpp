// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/loader.hpp"

#include <filesystem>
#include <new>

#include "core/scene/import/front_ends.hpp"
#include "core/scene/import/scene_format.hpp"
#include "core/scene/loader/json_scene.hpp"

namespace tessera::core {
namespace {

ReadScene* reader_of(SceneFormat format) {
  switch (format) {
    case SceneFormat::kTessera:
      break;
    case SceneFormat::kGltf:
      return read_gltf_scene;
    case SceneFormat::kPbrt:
      return read_pbrt_scene;
    case SceneFormat::kMitsuba:
      return read_mitsuba_scene;
    case SceneFormat::kObj:
    case SceneFormat::kPly:
    case SceneFormat::kStl:
      return read_mesh_scene;
  }
  return read_json_scene;
}

Result<SceneDescription> load(AssetSource& assets, const std::string& scene_path,
                              const std::string& display_path, const SceneLimits& limits) {
  const auto format = format_of(assets, scene_path);
  if (!format) return fail(format.error().within(display_path));
  return reader_of(*format)(assets, scene_path, display_path, limits);
}

}  // namespace

Result<SceneDescription> load_scene(AssetSource& assets, const std::string& scene_path,
                                    const std::string& display_path, const SceneLimits& limits) {
  try {
    auto scene = load(assets, scene_path, display_path, limits);
    // What is left of the image where the environment is hidden needs alpha to be of use.
    if (scene && scene->environment && !scene->environment->visible_to_camera)
      scene->settings.layers = scene->settings.layers.with(Layer::kAlpha);
    return scene;
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::kResourceExhausted, display_path + ": the scene does not fit into memory");
  }
}

Result<SceneDescription> load_scene_file(const std::string& path,
                                         const std::vector<ParameterOverride>& overrides,
                                         const SceneLimits& limits) {
  const std::filesystem::path file(path);
  FolderAssets folder(file.parent_path().string());
  OverriddenAssets assets(folder, file.filename().string(), overrides);
  return load_scene(assets, file.filename().string(), path, limits);
}

}  // namespace tessera::core
