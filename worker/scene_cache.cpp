#include "worker/scene_cache.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "core/scene/loader/asset_source.hpp"
#include "core/scene/loader/loader.hpp"
#include "worker/blob_cache.hpp"

namespace tessera::worker {
namespace {

// A fraction of the time for which the blob cache keeps what was used.
constexpr auto kMarkPeriod = std::chrono::minutes(10);

core::Result<std::shared_ptr<const core::Scene>> build_scene(const SceneFiles& files, int threads) {
  core::BundleAssets assets(files.blob_paths);
  auto description = core::load_scene(assets, files.scene_path, files.scene_path);
  if (!description) return core::fail(description.error());
  auto scene = core::Scene::build(std::move(*description), threads);
  if (!scene) return core::fail(scene.error());
  return std::make_shared<const core::Scene>(std::move(*scene));
}

}  // namespace

core::Result<std::shared_ptr<const core::Scene>> SceneCache::get(const SceneFiles& files) {
  const auto known =
      std::find_if(recent_.begin(), recent_.end(), [&](const auto& e) { return e.key == files.key; });
  if (known != recent_.end()) {
    recent_.splice(recent_.begin(), recent_, known);
    mark_files(*known, files);
    return known->scene;
  }
  // The oldest goes first, so that no more scenes than these are ever in memory.
  while (recent_.size() >= capacity_) recent_.pop_back();
  const auto start = Clock::now();
  auto scene = build_scene(files, threads_);
  if (!scene) return scene;
  const std::chrono::duration<double> took = Clock::now() - start;
  spdlog::info("built scene {} ({} primitives) in {:.2f} s", files.scene_path, (*scene)->primitives().count(),
               took.count());
  recent_.push_front({files.key, *scene, Clock::now()});
  return scene;
}

// A scene in memory needs no files, but a worker that is started anew, or has had too many other scenes,
// does.
void SceneCache::mark_files(Entry& entry, const SceneFiles& files) {
  if (Clock::now() - entry.files_marked < kMarkPeriod) return;
  entry.files_marked = Clock::now();
  for (const auto& [name, path] : files.blob_paths) mark_as_used(path);
}

}  // namespace tessera::worker
