// SPDX-License-Identifier: Apache-2.0
#include "worker/scene_cache.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "core/scene/cache/cache_folder.hpp"

namespace tessera::worker {
namespace {

// The blob cache removes the least recently used files first.
constexpr auto kMarkPeriod = std::chrono::minutes(10);

}  // namespace

core::Result<core::integrators::RenderPlans*> SceneCache::get(const SceneFiles& files, std::int32_t frame,
                                                              const std::stop_token& stop) {
  const auto entry = find_or_build(files, stop);
  if (!entry) return core::fail(entry.error());
  if (const core::Status shown = (*entry)->scene.set_frame(frame, threads_); !shown)
    return core::fail(shown.error().within(files.scene_path));
  return &(*entry)->plans;
}

core::Result<SceneCache::Entry*> SceneCache::find_or_build(const SceneFiles& files,
                                                           const std::stop_token& stop) {
  const auto known =
      std::find_if(recent_.begin(), recent_.end(), [&](const auto& e) { return e.key == files.key; });
  if (known != recent_.end()) {
    recent_.splice(recent_.begin(), recent_, known);
    mark_files(*known, files);
    return &*known;
  }
  // The oldest is removed first, so that memory never holds more than `capacity_` scenes.
  while (recent_.size() >= capacity_) recent_.pop_back();
  const auto start = Clock::now();
  auto built = build(files, stop);
  Metrics::add(metrics_.scene_load_ns, Clock::now() - start);
  ++(built ? metrics_.scenes_loaded : metrics_.scenes_failed);
  if (!built) return core::fail(built.error());
  Entry& entry = recent_.emplace_front(files.key, std::move(*built));
  const std::chrono::duration<double> took = Clock::now() - start;
  spdlog::info("made scene {} ({} primitives) ready in {:.2f} s", files.scene_path,
               entry.scene.primitives().count(), took.count());
  return &entry;
}

bool SceneCache::has_others(const SceneFiles& files) const {
  return std::any_of(recent_.begin(), recent_.end(),
                     [&](const Entry& entry) { return entry.key != files.key; });
}

core::Result<core::Scene> SceneCache::build(const SceneFiles& files, const std::stop_token& stop) const {
  const auto load = [&] { return load_(files, threads_, stop); };
  if (store_) {
    auto prepared = store_->prepare("bundle " + files.key, threads_, load);
    if (!prepared) return core::fail(prepared.error());
    return core::build_scene(std::move(*prepared), threads_);
  }
  auto description = load();
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
