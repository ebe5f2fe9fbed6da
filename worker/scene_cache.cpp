#include "worker/scene_cache.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>

#include "core/scene/loader/asset_source.hpp"
#include "core/scene/loader/loader.hpp"

namespace tessera::worker {
namespace {

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
      std::find_if(recent_.begin(), recent_.end(), [&](const auto& e) { return e.first == files.key; });
  if (known != recent_.end()) {
    recent_.splice(recent_.begin(), recent_, known);
    return known->second;
  }
  // The oldest goes first, so that no more scenes than these are ever in memory.
  while (recent_.size() >= capacity_) recent_.pop_back();
  const auto start = std::chrono::steady_clock::now();
  auto scene = build_scene(files, threads_);
  if (!scene) return scene;
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  spdlog::info("built scene {} ({} primitives) in {:.2f} s", files.scene_path, (*scene)->primitives().count(),
               took.count());
  recent_.emplace_front(files.key, *scene);
  return scene;
}

}  // namespace tessera::worker
