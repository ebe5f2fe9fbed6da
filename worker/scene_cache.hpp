// SPDX-License-Identifier: Apache-2.0
// A cache of the scenes rendered last. For the render thread only: building uses its threads.
#pragma once

#include <chrono>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "core/base/error.hpp"
#include "core/scene/cache/scene_store.hpp"
#include "core/scene/scene.hpp"
#include "worker/job.hpp"

namespace tessera::worker {

class SceneCache {
 public:
  // Scenes that are not in memory are read from the store, and written to it, if there is one.
  SceneCache(std::size_t capacity, int threads, std::optional<core::SceneStore> store)
      : capacity_(capacity), threads_(threads), store_(std::move(store)) {}

  // Loads and builds the scene if it is not in memory, and marks its files as used. Errors are those of
  // load_scene and Scene::build.
  core::Result<std::shared_ptr<const core::Scene>> get(const SceneFiles& files);
  // Whether scenes of other bundles are in memory.
  bool has_others(const SceneFiles& files) const;
  // Removes all scenes from memory.
  void clear() { recent_.clear(); }

 private:
  using Clock = std::chrono::steady_clock;
  struct Entry {
    std::string key;
    std::shared_ptr<const core::Scene> scene;
    Clock::time_point files_marked;
  };

  core::Result<core::Scene> build(const SceneFiles& files) const;
  static void mark_files(Entry& entry, const SceneFiles& files);

  std::size_t capacity_;
  int threads_;
  std::optional<core::SceneStore> store_;
  std::list<Entry> recent_;  // most recent first
};

}  // namespace tessera::worker
