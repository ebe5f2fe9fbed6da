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
  EXPECT_TRUE(new_cache().get(files, 0));
  std::filesystem::remove(blob);
  SceneCache cache = new_cache();
  const auto plans = cache.get(files, 0);
  ASSERT_TRUE(plans);
  EXPECT_EQ((*plans)->scene().primitives().sphere_count(), 1u);
  EXPECT_FALSE(SceneCache(1, 1, metrics, confined(), {}).get(files, 0)) << "without a store";
}

// Where there is no store, and where it takes no scene, the scene goes from one process to the other all the
// same.
TEST(SceneCache, DoesWithoutAStore) {
  const TemporaryFolder folder;
  const std::string blob = folder.path() / "blob";
  write_file(blob, kScene);
  Metrics metrics;
  const SceneFiles files{.key = "key", .scene_path = "scene.json", .blob_paths = {{"scene.json", blob}}};
  EXPECT_TRUE(SceneCache(1, 1, metrics, confined(), {}).get(files, 0));
  auto full = core::SceneStore::open(folder.path(), 1, [](const std::string&) {});
  EXPECT_TRUE(SceneCache(1, 1, metrics, confined(), std::move(full.value())).get(files, 0));
}

constexpr const char* kTurning = R"({
  "camera": {"position": [0, 0, 3], "look_at": [0, 0, 0]},
  "materials": {"clay": {"type": "lambert", "albedo": [0.5, 0.5, 0.5]}},
  "shapes": [{"type": "sphere", "radius": 1, "center": [1, 0, 0], "material": "clay", "transform": [
    {"rotate": {"axis": [0, 1, 0], "degrees": {"keyframes": [{"frame": 1, "value": 0}, {"frame": 13, "value": 360}]}}}
  ]}],
  "environment": {"radiance": [1, 1, 1]}
})";

// The frames of a job are made of one scene in memory, which is loaded once.
TEST(SceneCache, LoadsASceneOnceForAllFrames) {
  const TemporaryFolder folder;
  const std::string blob = folder.path() / "blob";
  write_file(blob, kTurning);
  Metrics metrics;
  const SceneFiles files{.key = "key", .scene_path = "scene.json", .blob_paths = {{"scene.json", blob}}};
  SceneCache cache(1, 1, metrics, confined(), {});
  const auto first = cache.get(files, 1);
  ASSERT_TRUE(first) << first.error().message;
  const core::Scene& scene = (*first)->scene();
  const core::Aabb at_first = scene.primitives().bounds(0);
  for (int frame = 12; frame > 0; --frame) {
    const auto plans = cache.get(files, frame);
    ASSERT_TRUE(plans);
    EXPECT_EQ(&(*plans)->scene(), &scene) << "the same memory";
    EXPECT_EQ(scene.frame(), frame);
    EXPECT_EQ(scene.primitives().bounds(0) == at_first, frame == 1);
  }
  EXPECT_EQ(metrics.scenes_loaded.load(), 1u);
}

// Pieces of jobs that differ in what preparation does not depend on take turns.
TEST(SceneCache, PreparesASceneOnceForAllPieces) {
  const TemporaryFolder folder;
  const std::string blob = folder.path() / "blob", other = folder.path() / "other";
  write_file(blob, kScene);
  write_file(other, kTurning);
  Metrics metrics;
  const SceneFiles still{.key = "still", .scene_path = "scene.json", .blob_paths = {{"scene.json", blob}}};
  const SceneFiles turning{
      .key = "turning", .scene_path = "scene.json", .blob_paths = {{"scene.json", other}}};
  SceneCache cache(2, 1, metrics, confined(), {});
  const auto sampler_of = [&](const SceneFiles& files, std::int32_t frame, std::uint64_t seed) {
    return &cache.get(files, frame).value()->get({.seed = seed}, 1).light_sampler();
  };
  const auto* const first = sampler_of(still, 0, 1);
  EXPECT_EQ(sampler_of(turning, 1, 1), sampler_of(turning, 1, 2));
  EXPECT_EQ(sampler_of(still, 0, 2), first);
  EXPECT_EQ(sampler_of(still, 5, 1), first) << "all frames of a still scene are the same";
}

TEST(SceneCache, NamesTheFrameThatCannotBeRendered) {
  const TemporaryFolder folder;
  const std::string blob = folder.path() / "blob";
  write_file(blob, R"({
  "camera": {"position": {"keyframes": [{"frame": 0, "value": [0, 0, 3]}, {"frame": 2, "value": [0, 0, -3]}]},
             "look_at": [0, 0, 0]},
  "materials": {"clay": {"type": "lambert"}},
  "shapes": [{"type": "sphere", "radius": 1, "material": "clay"}]
})");
  Metrics metrics;
  const SceneFiles files{.key = "key", .scene_path = "scene.json", .blob_paths = {{"scene.json", blob}}};
  SceneCache cache(1, 1, metrics, confined(), {});
  EXPECT_TRUE(cache.get(files, 2));
  EXPECT_EQ(cache.get(files, 1).error().message,
            "scene.json: frame 1: camera.look_at: must differ from camera.position");
}

}  // namespace
}  // namespace tessera::worker
