// SPDX-License-Identifier: Apache-2.0
#include "worker/scene_cache.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <set>
#include <string>
#include <utility>

#include "core/scene/cache/cache_folder.hpp"
#include "core/scene/loader/asset_source.hpp"
#include "core/scene/loader/loader.hpp"

namespace tessera::worker {
namespace {

// Well below the time for which the blob cache keeps unused files.
constexpr auto kMarkPeriod = std::chrono::minutes(10);

// Checks that the bytes match the digest, since the file may have changed after it was fetched. A file with
// other bytes is removed, so that it is fetched again.
core::Status check_blob(const SceneFiles& files, const std::string& name, const std::string& bytes) {
  const auto digest = files.digests.find(name);
  if (digest == files.digests.end() || proto::digest_of(bytes) == digest->second) return {};
  const std::string& path = files.blob_paths.at(name);
  std::remove(path.c_str());
  return core::fail(core::ErrorCode::kDataLoss, path + " has changed since it was fetched");
}

core::Result<core::SceneDescription> load_scene(const SceneFiles& files) {
  std::set<std::string> names;
  for (const auto& [name, path] : files.blob_paths) names.insert(name);
  const auto read = [&files](const std::string& name, const std::string& shown) -> core::Result<std::string> {
    auto bytes = core::read_asset(files.blob_paths.at(name), shown);
    if (bytes)
      if (const core::Status right = check_blob(files, name, *bytes); !right)
        return core::fail(right.error());
    return bytes;
  };
  core::BundleAssets assets(std::move(names), read);
  return core::load_scene(assets, files.scene_path, files.scene_path);
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
  // The oldest is removed first, so that memory never holds more than `capacity_` scenes.
  while (recent_.size() >= capacity_) recent_.pop_back();
  const auto start = Clock::now();
  auto built = build(files);
  if (!built) return core::fail(built.error());
  auto scene = std::make_shared<const core::Scene>(std::move(*built));
  const std::chrono::duration<double> took = Clock::now() - start;
  spdlog::info("made scene {} ({} primitives) ready in {:.2f} s", files.scene_path,
               scene->primitives().count(), took.count());
  recent_.push_front({files.key, scene, Clock::now()});
  return scene;
}

bool SceneCache::has_others(const SceneFiles& files) const {
  return std::any_of(recent_.begin(), recent_.end(),
                     [&](const Entry& entry) { return entry.key != files.key; });
}

core::Result<core::Scene> SceneCache::build(const SceneFiles& files) const {
  if (store_) {
    auto prepared = store_->prepare("bundle " + files.key, threads_, [&] { return load_scene(files); });
    if (!prepared) return core::fail(prepared.error());
    return core::build_scene(std::move(*prepared), threads_);
  }
  auto description = load_scene(files);
  if (!description) return core::fail(description.error());
  return core::Scene::build(std::move(*description), threads_);
}

// A scene in memory does not need its files, but the worker does after a restart, or when the scene was
// evicted.
void SceneCache::mark_files(Entry& entry, const SceneFiles& files) {
  if (Clock::now() - entry.files_marked < kMarkPeriod) return;
  entry.files_marked = Clock::now();
  for (const auto& [name, path] : files.blob_paths) core::mark_as_used(path);
}

}  // namespace tessera::worker
