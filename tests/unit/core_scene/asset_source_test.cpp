// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/asset_source.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "core/scene/loader/loader.hpp"
#include "tests/support/bundle_files.hpp"
#include "tests/unit/core_scene/memory_assets.hpp"

namespace tessera::core {
namespace {

namespace fs = std::filesystem;

class Folder : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "tessera-assets-XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& bytes) {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
  }
  std::string error_of(const std::string& name) {
    const auto bytes = FolderAssets(folder_.string()).read(name);
    return bytes ? "no error" : bytes.error().message;
  }
  std::string in_folder() const { return " in the folder '" + folder_.string() + "'"; }

  fs::path folder_;
};

TEST_F(Folder, GivesTheBytesOfFiles) {
  const std::string bytes("a\0b\r\n\xff", 6);
  write("models/a b.bin", bytes);
  write("empty", "");
  FolderAssets assets(folder_.string());
  EXPECT_EQ(assets.read("models/a b.bin").value(), bytes);
  EXPECT_EQ(assets.read("models/../models/a b.bin").value(), bytes);
  EXPECT_EQ(assets.read((folder_ / "models/a b.bin").string()).value(), bytes);
  EXPECT_EQ(assets.read("empty").value(), "");
}

TEST_F(Folder, SaysWhyAFileCannotBeRead) {
  write("models/a", "");
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(error_of("none.obj"), "'none.obj'" + in_folder() + " does not exist");
  EXPECT_EQ(error_of("models/a/b"), "'models/a/b'" + in_folder() + " does not exist");
  EXPECT_EQ(error_of("models"), "'models'" + in_folder() + " is a folder, not a file");
  EXPECT_EQ(error_of("pipe"), "'pipe'" + in_folder() + " is not an ordinary file");
  EXPECT_EQ(error_of(""), "'' is not the name of a file");
  EXPECT_EQ(error_of(std::string("a\0b", 3)), "'a\\x00b' is not the name of a file");
  EXPECT_EQ(FolderAssets("").read("none at all").error().message, "'none at all' does not exist");
  EXPECT_EQ(FolderAssets("").read("none at all").error().code, ErrorCode::kNotFound);
}

// Root may read everything: for its scope, root is somebody else.
class Unprivileged {
 public:
  Unprivileged() : user_(geteuid()) {
    if (user_ == 0) {
      EXPECT_EQ(seteuid(65534), 0);
    }
  }
  ~Unprivileged() { EXPECT_EQ(seteuid(user_), 0); }

 private:
  uid_t user_;
};

TEST_F(Folder, SaysThatAFileMayNotBeRead) {
  write("secret", "x");
  fs::permissions(folder_ / "secret", fs::perms::none);
  fs::permissions(folder_, fs::perms::others_exec, fs::perm_options::add);
  const Unprivileged unprivileged;
  EXPECT_EQ(error_of("secret"), "'secret'" + in_folder() + " cannot be read: Permission denied");
}

TEST_F(Folder, HoldsAScene) {
  write("s/scene.json",
        test::scene_with("", "", "{\"type\": \"mesh\", \"file\": \"../m/t.obj\", \"material\": \"light\"}"));
  write("m/t.obj", test::kTriangleObj);
  const std::string path = (folder_ / "s/scene.json").string();
  const auto scene = load_scene_file(path);
  ASSERT_TRUE(scene.has_value()) << scene.error().message;
  EXPECT_EQ(scene->shapes.size(), 2u);

  const std::string none = (folder_ / "s/none.json").string();
  EXPECT_EQ(load_scene_file(none).error().message,
            none + ": 'none.json' in the folder '" + (folder_ / "s").string() + "' does not exist");
  EXPECT_EQ(load_scene_file(none).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(load_scene_file((folder_ / "s").string()).error().message,
            (folder_ / "s").string() + ": 's'" + in_folder() + " is a folder, not a file");
  EXPECT_EQ(load_scene_file("").error().message, ": '' is not the name of a file");
}

TEST_F(Folder, HoldsTheBlobsOfABundle) {
  write("blob1", "one");
  write("secret", "two");
  BundleAssets assets =
      bundle_at({{"../scenes/a.obj", (folder_ / "blob1").string()}, {"lost", (folder_ / "blob2").string()}});
  EXPECT_EQ(assets.read("../scenes/a.obj").value(), "one");
  EXPECT_EQ(assets.read((folder_ / "secret").string()).error().message,
            "'" + (folder_ / "secret").string() + "' is not in the scene's bundle");
  EXPECT_EQ(assets.read("/etc/passwd").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(assets.read("lost").error().message, "'lost' does not exist");
}

TEST(RecordingAssets, TellsWhatASceneNeeds) {
  const std::string scene = test::scene_with("\"textures\": {\"t\": {\"file\": \"gray.png\"}}", "",
                                             "{\"type\": \"mesh\", \"file\": \"m/a.obj\"}");
  test::MemoryAssets files({{"scene.json", scene},
                            {"gray.png", test::png(test::one_color(1, 1, {}))},
                            {"m/a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n"},
                            {"m/a.mtl", "newmtl a\nmap_Kd b.png\n"},
                            {"m/b.png", test::png(test::one_color(1, 1, {}))},
                            {"unused", ""}});
  std::map<std::string, std::string> seen;
  RecordingAssets recording(files,
                            [&](const std::string& path, const std::string& bytes) { seen[path] = bytes; });
  const auto loaded = load_scene(recording, "scene.json", "scene.json");
  ASSERT_TRUE(loaded.has_value()) << loaded.error().message;
  std::vector<std::string> names;
  for (const auto& [path, bytes] : seen) names.push_back(path);
  EXPECT_EQ(names, (std::vector<std::string>{"gray.png", "m/a.mtl", "m/a.obj", "m/b.png", "scene.json"}));
  EXPECT_EQ(seen.at("scene.json"), scene);

  // And nothing else is needed: what was recorded loads again by itself.
  test::MemoryAssets bundle(seen);
  EXPECT_TRUE(load_scene(bundle, "scene.json", "scene.json").has_value());
}

}  // namespace
}  // namespace tessera::core
