// SPDX-License-Identifier: Apache-2.0
#include "worker/scene_cache.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "confined.hpp"
#include "tests/support/temporary_folder.hpp"

namespace tessera::worker {
namespace {

constexpr const char* kScene = R"({
  "camera": {"position": [0, 0, 3], "look_at": [0, 0, 0]},
  "materials": {"clay": {"type": "lambert", "albedo": [0.5, 0.5, 0.5]}},
  "shapes": [{"type": "sphere", "radius": 1, "material": "clay"}],
  "environment": {"radiance": [1, 1, 1]}
})";

// A restarted worker finds the built scene of its predecessor, without the scene's files.
TEST(SceneCache, KeepsBuiltScenesForTheNextWorker) {
  const TemporaryFolder folder;
  const std::string blob = folder.path() / "blob";
  write_file(blob, kScene);
  Metrics metrics;
  const SceneFiles files{.key = "key", .scene_path = "scene.json", .blob_paths = {{"scene.json", blob}}};
  const auto new_cache = [&] {
    return SceneCache(1, 1, metrics, confined(),
                      core::SceneStore::open(folder.path(), UINT64_MAX, [](const std::string& message) {
                        ADD_FAILURE() << message;
                      }).value());
  };
  EXPECT_TRUE(new_cache().get(files));
  std::filesystem::remove(blob);
  const auto scene = new_cache().get(files);
  ASSERT_TRUE(scene);
  EXPECT_EQ((*scene)->primitives().sphere_count(), 1u);
  EXPECT_FALSE(SceneCache(1, 1, metrics, confined(), {}).get(files)) << "without a store";
}

// Where there is no store, and where it takes no scene, the scene goes from one process to the other all the
// same.
TEST(SceneCache, DoesWithoutAStore) {
  const TemporaryFolder folder;
  const std::string blob = folder.path() / "blob";
  write_file(blob, kScene);
  Metrics metrics;
  const SceneFiles files{.key = "key", .scene_path = "scene.json", .blob_paths = {{"scene.json", blob}}};
  EXPECT_TRUE(SceneCache(1, 1, metrics, confined(), {}).get(files));
  auto full = core::SceneStore::open(folder.path(), 1, [](const std::string&) {});
  EXPECT_TRUE(SceneCache(1, 1, metrics, confined(), std::move(full.value())).get(files));
}

}  // namespace
}  // namespace tessera::worker
