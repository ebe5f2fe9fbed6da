// SPDX-License-Identifier: Apache-2.0
// write_scene_reference ROOT: writes what follows from the tables of keys into scenes/scene.schema.json and
// docs/scene-format.md below the folder ROOT.
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>

#include "core/scene/reference/reference_tables.hpp"
#include "core/scene/reference/schema.hpp"

namespace {

std::string contents(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

bool write(const std::string& path, const std::string& text) {
  std::ofstream file(path);
  file << text;
  return static_cast<bool>(file.flush());
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) {
    std::cerr << "usage: write_scene_reference ROOT\n";
    return 1;
  }
  const std::string root = arguments[1];
  const std::string schema = root + "/scenes/scene.schema.json", page = root + "/docs/scene-format.md";
  const bool is_written = write(schema, tessera::core::update_schema(contents(schema)).text) &&
                          write(page, tessera::core::update_reference(contents(page)));
  return is_written ? 0 : 1;
}
