// SPDX-License-Identifier: Apache-2.0
// A scene that was kept is the scene that was built, whatever has happened to the file.
#include "core/scene/cache/scene_store.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "core/integrators/fingerprint.hpp"
#include "core/integrators/render.hpp"
#include "core/scene/cache/archive.hpp"
#include "core/scene/loader/loader.hpp"
#include "tests/support/temporary_folder.hpp"

namespace tessera::core {
namespace {

namespace fs = std::filesystem;

constexpr const char* kScene = R"({
  "camera": {"position": [0.3, 0.3, 3], "look_at": [0.3, 0.3, 0]},
  "shapes": [{"type": "mesh", "file": "triangle.obj"}],
  "environment": {"radiance": [1, 1, 1]}
})";
constexpr const char* kObj = "mtllib red.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n";

class Store : public testing::Test {
 protected:
  Store() : store_(open(UINT64_MAX)) {
    write_file(scene_folder_.path() / "scene.json", kScene);
    write_file(scene_folder_.path() / "triangle.obj", kObj);
    write_file(scene_folder_.path() / "red.mtl", "newmtl red\nKd 0.8 0.1 0.1\n");
  }

  SceneStore open(std::uint64_t max_bytes) {
    const auto warn = [this](const std::string& message) { warnings_.push_back(message); };
    return SceneStore::open(folder_.path() / "new", max_bytes, warn).value();
  }
  std::vector<fs::path> files(const std::string& extension) const {
    std::vector<fs::path> found;
    for (const auto& entry : fs::directory_iterator(folder_.path() / "new"))
      if (entry.path().extension() == extension) found.push_back(entry.path());
    return found;
  }
  fs::path only_scene() const { return files(".scene").at(0); }

  // Prepares and builds a scene with something of everything; `loads` counts how often it had to be made.
  Scene everything(const std::string& key = "everything") {
    auto prepared = store_.prepare(key, 2, [this]() -> Result<SceneDescription> {
      ++loads_;
      return integrators::fingerprint_scene();
    });
    return build_scene(std::move(prepared.value()), 2).value();
  }
  // Of the scene file. Says whether it came from the store.
  bool build_from_file() {
    auto prepared = store_.prepare_file(scene_folder_.path() / "scene.json", 2).value();
    const bool was_kept = prepared.bvh.has_value();
    EXPECT_TRUE(build_scene(std::move(prepared), 2));
    return was_kept;
  }

  TemporaryFolder folder_, scene_folder_;
  std::vector<std::string> warnings_;
  int loads_ = 0;
  SceneStore store_;
};

FilmTile render_small(const Scene& scene) {
  RenderSettings settings = scene.settings();
  settings.width_px = settings.height_px = 32;
  return render(integrators::prepare(scene, settings, 2), {0, 0, 32, 32}, {0, 4}, 2);
}

TEST_F(Store, GivesTheSameSceneAndImage) {
  const Scene built = everything(), kept = everything();
  EXPECT_EQ(loads_, 1);
  EXPECT_TRUE(kept.bvh() == built.bvh());
  const FilmTile a = render_small(built), b = render_small(kept);
  EXPECT_TRUE(a.sums == b.sums && a.odd_sums == b.odd_sums);
  EXPECT_TRUE(warnings_.empty());
}

// All of it: what was read back is written to the same bytes again.
TEST_F(Store, LosesNothing) {
  everything();
  const std::string first = read_file(only_scene());
  auto kept = store_.prepare("everything", 2, [] { return integrators::fingerprint_scene(); }).value();
  fs::remove(only_scene());
  auto again =
      store_.prepare("everything", 2, [&]() -> Result<SceneDescription> { return kept.description; });
  ASSERT_TRUE(again->writer);
  again->writer->finish(*kept.bvh);
  EXPECT_TRUE(read_file(only_scene()) == first);
}

TEST_F(Store, IgnoresWhatIsDamagedWithAWarning) {
  const Scene built = everything();
  const std::string good = read_file(only_scene());
  int expected_loads = 1;
  for (const std::size_t at :
       {std::size_t{0}, std::size_t{9}, std::size_t{13}, good.size() / 3, good.size() / 2, good.size() - 1}) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 4);
    for (const std::string& bytes : {bad, good.substr(0, at)}) {
      write_file(only_scene(), bytes);
      warnings_.clear();
      const Scene scene = everything();
      EXPECT_TRUE(scene.bvh() == built.bvh());
      if (at == good.size() / 2) {
        EXPECT_TRUE(render_small(scene).sums == render_small(built).sums);
      }
      EXPECT_EQ(loads_, ++expected_loads);
      EXPECT_THAT(warnings_, testing::ElementsAre(testing::HasSubstr("scene cache"))) << at;
      EXPECT_TRUE(read_file(only_scene()) == good) << "mended";
    }
  }
}

TEST_F(Store, KnowsASceneFileByAllThatItWasMadeOf) {
  EXPECT_FALSE(build_from_file());
  EXPECT_TRUE(build_from_file());
  for (const char* name : {"triangle.obj", "red.mtl", "scene.json"}) {
    const std::string before = read_file(scene_folder_.path() / name);
    write_file(scene_folder_.path() / name, before + "\n");
    EXPECT_FALSE(build_from_file()) << name;
    EXPECT_TRUE(build_from_file()) << name;
    write_file(scene_folder_.path() / name, before);
  }
  EXPECT_TRUE(build_from_file()) << "as at first";
  EXPECT_TRUE(warnings_.empty());
}

// "red wood.mtl" is one name if there is such a file, and else two. A scene that lacks a file it looked for
// is not kept: the file may appear.
TEST_F(Store, KeepsNoSceneThatLacksAFile) {
  write_file(scene_folder_.path() / "triangle.obj", "mtllib red wood.mtl\n" + std::string(kObj).substr(15));
  write_file(scene_folder_.path() / "red", "newmtl red\nKd 0.8 0.1 0.1\n");
  write_file(scene_folder_.path() / "wood.mtl", "newmtl wood\nKd 0.8 0.1 0.1\n");
  EXPECT_FALSE(build_from_file());
  EXPECT_FALSE(build_from_file());
  write_file(scene_folder_.path() / "red wood.mtl", "newmtl red\nKd 0.1 0.1 0.8\n");
  EXPECT_FALSE(build_from_file());
}

TEST_F(Store, ErrorsAreThoseOfLoading) {
  fs::remove(scene_folder_.path() / "triangle.obj");
  const std::string path = scene_folder_.path() / "scene.json";
  const auto prepared = store_.prepare_file(path, 1);
  ASSERT_FALSE(prepared);
  EXPECT_EQ(prepared.error().message, load_scene_file(path).error().message);
}

TEST_F(Store, CanBeSharedByManyAtOnce) {
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([&] {
      for (int n = 0; n < 5; ++n)
        build_scene(store_.prepare("shared", 1, [] { return integrators::fingerprint_scene(); }).value(), 1)
            .value();
    });
  for (std::thread& thread : threads) thread.join();
  everything("shared");
  EXPECT_EQ(loads_, 0);
  EXPECT_TRUE(warnings_.empty());
  EXPECT_TRUE(files(".partial").empty());
}

// As if the names of two scenes were the same.
TEST_F(Store, IsNotTakenInByAnotherScenesFile) {
  everything("one");
  const fs::path first = only_scene();
  everything("another");
  const auto both = files(".scene");
  fs::copy_file(first, both[0] == first ? both[1] : both[0], fs::copy_options::overwrite_existing);
  everything("another");
  EXPECT_EQ(loads_, 3);
  EXPECT_THAT(warnings_, testing::ElementsAre(testing::HasSubstr("is of something else")));
}

TEST_F(Store, IsRefusedWhereOthersCanWrite) {
  fs::permissions(folder_.path(), fs::perms::all);
  const auto store = SceneStore::open(folder_.path(), UINT64_MAX, [](const std::string&) {});
  ASSERT_FALSE(store);
  EXPECT_THAT(store.error().message, testing::HasSubstr("others may write to it"));
}

TEST_F(Store, DoesNotKeepWhatIsLargerThanItMayBe) {
  everything();
  const std::uint64_t bytes = fs::file_size(only_scene());
  for (const std::uint64_t max_bytes : {std::uint64_t{0}, bytes * 3 / 4}) {
    store_ = open(max_bytes);
    fs::remove(only_scene());
    everything();
    EXPECT_TRUE(files(".scene").empty() && files(".partial").empty());
    EXPECT_THAT(warnings_,
                testing::ElementsAre(testing::HasSubstr("is not kept: the scene cache may have no more")));
    warnings_.clear();
    store_ = open(UINT64_MAX);
    everything();
  }
}

TEST_F(Store, StaysWithinItsSize) {
  everything();
  const fs::path first = only_scene();
  fs::last_write_time(first, fs::file_time_type::clock::now() - std::chrono::minutes(2));
  store_ = open(fs::file_size(first));
  everything("another");
  EXPECT_FALSE(fs::exists(first));
  EXPECT_EQ(files(".scene").size(), 1u);
}

// A scene counts from the moment when room is made for it, also in the store of another worker.
TEST_F(Store, CountsScenesThatAreBeingWritten) {
  everything();
  const std::uint64_t bytes = fs::file_size(only_scene());
  fs::remove(only_scene());
  const auto begin = [&](const std::string& key) {
    return open(bytes * 3 / 2).prepare(key, 1, [] { return integrators::fingerprint_scene(); }).value();
  };
  std::vector<PreparedScene> prepared;
  for (const char* key : {"one", "two", "three"}) prepared.push_back(begin(key));
  std::uint64_t reserved = 0;
  for (const fs::path& file : files(".partial")) reserved += fs::file_size(file);
  EXPECT_GE(reserved, stored::stored_bytes(prepared[0].description));
  EXPECT_LE(reserved, bytes * 3 / 2);
  for (PreparedScene& scene : prepared) ASSERT_TRUE(build_scene(std::move(scene), 1));
  EXPECT_TRUE(files(".partial").empty());
  std::uint64_t kept = 0;
  for (const fs::path& file : files(".scene")) kept += fs::file_size(file);
  EXPECT_LE(kept, bytes * 3 / 2);
}

}  // namespace
}  // namespace tessera::core
