// SPDX-License-Identifier: Apache-2.0
#include "client/example_scenes.hpp"

#include <filesystem>
#include <system_error>

namespace tessera::client {
namespace {

namespace fs = std::filesystem;

fs::path scenes_folder() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  return error ? fs::path() : program.parent_path().parent_path() / "share/tessera/scenes";
}

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error) && !fs::is_directory(path, error);
}

}  // namespace

std::string find_scene(const std::string& name) {
  if (name.empty() || fs::path(name).is_absolute() || is_file(name)) return name;
  const fs::path folder = scenes_folder();
  if (folder.empty()) return name;
  for (const fs::path& path : {folder / name / "scene.json", folder / (name + ".json")})
    if (is_file(path)) return path.string();
  return name;
}

}  // namespace tessera::client
