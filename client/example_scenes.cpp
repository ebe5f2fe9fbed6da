// SPDX-License-Identifier: Apache-2.0
#include "client/example_scenes.hpp"

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <vector>

#include "core/base/suggestion.hpp"

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

// The name of the example scene in this file: "cornell" for cornell/scene.json.
std::string example_name(const fs::path& file) {
  const fs::path folder = file.parent_path();
  return (file.filename() == "scene.json" ? folder : folder / file.stem()).string();
}

// In alphabetical order.
std::vector<std::string> example_names() {
  std::vector<std::string> names;
  const fs::path folder = scenes_folder();
  std::error_code error;
  for (const auto& group : fs::directory_iterator(folder, error)) {
    std::error_code no_folder;  // such as scene.schema.json
    for (const auto& entry : fs::directory_iterator(group, no_folder))
      if (entry.path().extension() == ".json")
        names.push_back(example_name(entry.path().lexically_relative(folder)));
  }
  std::sort(names.begin(), names.end());
  return names;
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

std::string suggest_example(const std::string& name) {
  if (is_file(find_scene(name)) || fs::path(name).is_absolute()) return "";
  const std::vector<std::string> names = example_names();
  std::vector<std::string_view> group;
  for (const std::string& example : names)
    if (example.starts_with(name + "/")) group.push_back(example);
  const std::string there_is_none = "there is no scene " + core::in_quotes(name);
  if (!group.empty()) return there_is_none + core::suggestion(name, group);
  const auto similar = core::similar_name(name, {names.begin(), names.end()});
  return similar ? there_is_none + "; did you mean " + core::in_quotes(*similar) + "?" : "";
}

}  // namespace tessera::client
