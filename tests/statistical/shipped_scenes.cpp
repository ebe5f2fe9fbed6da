// SPDX-License-Identifier: Apache-2.0
#include "tests/statistical/shipped_scenes.hpp"

#include <filesystem>
#include <map>

#include "core/scene/loader/loader.hpp"

namespace tessera::test {
namespace {

std::map<std::string, std::string> paths_by_name() {
  std::map<std::string, std::string> paths;
  for (const auto& folder : std::filesystem::directory_iterator(TESSERA_SCENES_DIR)) {
    if (!folder.is_directory()) continue;
    for (const auto& file : std::filesystem::directory_iterator(folder.path())) {
      if (file.path().extension() != ".json") continue;
      const std::string name = folder.path().filename().string(), stem = file.path().stem().string();
      paths[stem == "scene" ? name : name + "_" + stem] = file.path().string();
    }
  }
  return paths;
}

}  // namespace

std::vector<std::string> shipped_scenes() {
  std::vector<std::string> names;
  for (const auto& [name, path] : paths_by_name()) names.push_back(name);
  return names;
}

core::SceneDescription load_shipped_scene(const std::string& name) {
  return core::load_scene_file(paths_by_name().at(name)).value();
}

}  // namespace tessera::test
