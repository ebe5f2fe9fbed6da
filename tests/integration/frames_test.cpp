// SPDX-License-Identifier: Apache-2.0
// Animations on a farm: one job with an image for each frame.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/integration/farm_processes.hpp"

namespace tessera::test {
namespace {

using ::testing::HasSubstr;

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// A triangle that turns and takes another colour under a lamp that moves, seen by a camera on its way. The
// mesh is far larger than the scene file.
void write_turntable(const std::filesystem::path& folder) {
  std::ofstream obj(folder / "large.obj");
  obj << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  for (int i = 0; i < 20'000; ++i) obj << "# nothing to see here\n";
  std::ofstream(folder / "turn.json") << R"({
  "render": {"width": 90, "height": 70, "spp": 3},
  "camera": {"position": {"keyframes": [{"frame": 1, "value": [0, 1, 4]}, {"frame": 13, "value": [1, 1, 4]}]},
             "look_at": [0, 0, 0], "shutter": [0, 0.5]},
  "materials": {"clay": {"type": "lambert", "albedo": {"keyframes": [{"frame": 1, "value": [0.8, 0.4, 0.2]},
                                                                     {"frame": 13, "value": [0.2, 0.4, 0.8]}]}}},
  "environment": {"radiance": 0.3},
  "lights": [{"type": "point", "position": {"keyframes": [{"frame": 1, "value": [0, 3, 2]},
                                                          {"frame": 13, "value": [2, 3, 0]}]}, "intensity": 9}],
  "shapes": [
    {"type": "quad", "corner": [-4, -1, 4], "edge_u": [8, 0, 0], "edge_v": [0, 0, -8], "material": "clay"},
    {"type": "mesh", "file": "large.obj", "material": "clay", "transform": [
      {"rotate": {"axis": [0, 1, 0], "degrees": {"keyframes": [{"frame": 1, "value": 0}, {"frame": 13, "value": 360}]}}}
    ]}
  ]
})";
}

class Frames : public FarmTest {
 protected:
  Frames() {
    std::filesystem::create_directories(folder_ / "scene");
    write_turntable(folder_ / "scene");
  }
  std::string scene() { return (folder_ / "scene" / "turn.json").string(); }
  std::string file(const std::string& name) { return (folder_ / "scene" / name).string(); }
  std::uint64_t stored_bytes() {
    std::uint64_t bytes = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(state_ / "blobs"))
      if (entry.is_regular_file()) bytes += entry.file_size();
    return bytes;
  }
};

TEST_F(Frames, OfAJobHaveTheBytesOfALocalRender) {
  start_coordinator();
  start_worker("one", 1);
  start_worker("two", 2);
  const Outcome submitted = tessera(
      {"submit", scene(), "--frames", "1-12", "--preview-first", "--wait", "-o", file("farm.##.exr")});
  ASSERT_EQ(submitted.exit_code, 0) << submitted.err;
  ASSERT_EQ(tessera({"render", scene(), "--frames", "1-12", "-o", file("here.##.exr")}).exit_code, 0);
  for (int frame = 1; frame <= 12; ++frame) {
    const std::string number = (frame < 10 ? "0" : "") + std::to_string(frame);
    const std::string image = bytes_of(file("farm." + number + ".exr"));
    EXPECT_FALSE(image.empty());
    EXPECT_TRUE(image == bytes_of(file("here." + number + ".exr"))) << "frame " << frame;
  }
  const std::vector<v1::Job> all = jobs();
  ASSERT_EQ(all.size(), 1u);
  const v1::Job described = job(all[0].id());
  ASSERT_EQ(described.images_size(), 12);
  EXPECT_EQ(described.images(0).frame(), 1);
  EXPECT_EQ(described.images(1).frame(), 7);
  EXPECT_EQ(described.images(2).frame(), 12);
  EXPECT_EQ(described.images(3).frame(), 2);
  // The scene is stored once.
  EXPECT_EQ(stored_bytes(),
            std::filesystem::file_size(scene()) + std::filesystem::file_size(file("large.obj")));
}

TEST_F(Frames, WithLayersHaveTheBytesOfALocalRender) {
  start_coordinator();
  start_worker("one", 1);
  start_worker("two", 2);
  const std::vector<std::string> more{"--frames", "1,4", "--layers", "all", "-o"};
  std::vector<std::string> submit{"submit", scene(), "--wait"}, render{"render", scene()};
  submit.insert(submit.end(), more.begin(), more.end());
  render.insert(render.end(), more.begin(), more.end());
  submit.push_back(file("farm.#.exr"));
  render.push_back(file("here.#.exr"));
  const Outcome submitted = tessera(submit);
  ASSERT_EQ(submitted.exit_code, 0) << submitted.err;
  ASSERT_EQ(tessera(render).exit_code, 0);
  for (const char* number : {"1", "4"}) {
    const std::string image = bytes_of(file(std::string("farm.") + number + ".exr"));
    EXPECT_THAT(image, HasSubstr("CryptoObject00.r"));
    EXPECT_TRUE(image == bytes_of(file(std::string("here.") + number + ".exr"))) << "frame " << number;
  }
  const std::string id = jobs().at(0).id();
  ASSERT_EQ(tessera({"image", id, "--layer", "normal", "-o", file("normal.pfm")}).exit_code, 0);
  const Outcome none = tessera({"image", id, "--layer", "normals", "-o", file("none.pfm")});
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.err, HasSubstr("layer: must be one of alpha, direct"));
}

TEST_F(Frames, AreFetchedByTheirNumbers) {
  start_coordinator();
  start_worker("one", 2);
  const Outcome submitted = tessera({"submit", scene(), "--frames", "2,9", "--spp", "1"});
  ASSERT_EQ(submitted.exit_code, 0) << submitted.err;
  const std::string id = submitted.out.substr(0, submitted.out.find('\n'));
  ASSERT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE));
  ASSERT_EQ(tessera({"image", id, "-o", file("all.###.exr")}).exit_code, 0);
  ASSERT_EQ(tessera({"image", id, "--frames", "9", "-o", file("nine.exr")}).exit_code, 0);
  ASSERT_EQ(tessera({"image", id, "--image", "1", "-o", file("second.exr")}).exit_code, 0);
  EXPECT_TRUE(bytes_of(file("all.009.exr")) == bytes_of(file("nine.exr")));
  EXPECT_TRUE(bytes_of(file("second.exr")) == bytes_of(file("nine.exr")));
  EXPECT_FALSE(bytes_of(file("all.002.exr")) == bytes_of(file("all.009.exr")));
  const Outcome none = tessera({"image", id, "--frames", "3", "-o", file("none.exr")});
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.err, HasSubstr("has no frame 3"));
}

TEST_F(Frames, CanHaveParametersReplaced) {
  start_coordinator();
  start_worker("one", 2);
  const std::vector<std::string> more{
      "--frames", "4", "-D", "materials.clay.albedo=[0.1, 0.2, 0.9]", "-D", "camera.vertical_fov_degrees=25",
      "-o"};
  std::vector<std::string> submit{"submit", scene(), "--wait"}, render{"render", scene()};
  submit.insert(submit.end(), more.begin(), more.end());
  render.insert(render.end(), more.begin(), more.end());
  submit.push_back(file("farm.exr"));
  render.push_back(file("here.exr"));
  const Outcome submitted = tessera(submit);
  ASSERT_EQ(submitted.exit_code, 0) << submitted.err;
  ASSERT_EQ(tessera(render).exit_code, 0);
  EXPECT_TRUE(bytes_of(file("farm.exr")) == bytes_of(file("here.exr")));
  const Outcome wrong = tessera({"submit", scene(), "-D", "lights[3].intensity=1"});
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_THAT(wrong.err, HasSubstr("lights[3].intensity: 'lights' has 1 elements"));
}

}  // namespace
}  // namespace tessera::test
