// SPDX-License-Identifier: Apache-2.0
// Tests that run the program `tessera` in a folder of their own, with a scene in it.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "core/image/file_io.hpp"
#include "tests/unit/client/process.hpp"

namespace tessera::client {

// A glowing sphere seen from the point (0, 0, 4).
inline std::string scene_text(const std::string& radius, const std::string& center) {
  return R"({
  "render": {"width": 40, "height": 30, "spp": 4},
  "camera": {"position": [0, 0, 4], "look_at": [0, 0, 0]},
  "materials": {"glow": {"type": "lambert", "albedo": 0.5, "emission": [2, 1, 0.5]}},
  "shapes": [{"type": "sphere", "radius": )" +
         radius + R"(, "center": )" + center + R"(, "material": "glow"}]
})";
}

class CommandLine : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = testing::TempDir() + "command_line.XXXXXX";
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    write("scene.json", scene_text("1", "[0, 0, 0]"));
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string path(const std::string& name) const { return folder_ / name; }
  void write(const std::string& name, const std::string& text) {
    ASSERT_TRUE(core::write_file_atomically(path(name), text));
  }
  std::string read(const std::string& name) const { return core::read_file(path(name)).value_or(""); }
  std::vector<std::string> names() const {
    std::vector<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(folder_))
      found.push_back(entry.path().filename());
    return found;
  }
  ProcessResult render(std::vector<std::string> more) const {
    more.insert(more.begin(), {"render", path("scene.json")});
    return run_tessera(more);
  }

  std::filesystem::path folder_;
};

}  // namespace tessera::client
