// SPDX-License-Identifier: Apache-2.0
// A cache of the scenes rendered last, with their plans. For the render thread only: building uses its
// threads.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <list>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>

#include "core/base/error.hpp"
#include "core/integrators/render_plan.hpp"
#include "core/scene/cache/scene_store.hpp"
#include "core/scene/scene.hpp"
#include "worker/job.hpp"
#include "worker/metrics.hpp"

namespace tessera::worker {

// Reads a scene's files; load_confined() for short. CANCELLED after a stop request.
using LoadScene = std::function<core::Result<core::SceneDescription>(const SceneFiles& files, int threads,
                                                                     const std::stop_token& stop)>;

class SceneCache {
 public:
  // Scenes that are not in memory are read from the store, and written to it, if there is one. Scenes that
  // are not there are loaded by `load`.
  SceneCache(std::size_t capacity, int threads, Metrics& metrics, LoadScene load,
             std::optional<core::SceneStore> store)
      : capacity_(capacity),
        threads_(threads),
        metrics_(metrics),
        load_(std::move(load)),
        store_(std::move(store)) {}

  // The plans of the scene at a frame, valid until the next call. Loads and builds the scene if it is not in
  // memory, and marks its files as used. Errors are those of loading, of Scene::build and of
  // Scene::set_frame.
  core::Result<core::integrators::RenderPlans*> get(const SceneFiles& files, std::int32_t frame,
                                                    const std::stop_token& stop = {});
  // Whether scenes of other bundles are in memory.
  bool has_others(const SceneFiles& files) const;
  // Removes all scenes from memory.
  void clear() { recent_.clear(); }

 private:
  using Clock = std::chrono::steady_clock;
  struct Entry {
    Entry(std::string of_key, core::Scene built) : key(std::move(of_key)), scene(std::move(built)) {}

    const std::string key;
    core::Scene scene;
    core::integrators::RenderPlans plans{scene};
    Clock::time_point files_marked = Clock::now();
  };

  // The entry of the scene, which is then the first.
  core::Result<Entry*> find_or_build(const SceneFiles& files, const std::stop_token& stop);
  core::Result<core::Scene> build(const SceneFiles& files, const std::stop_token& stop) const;
  static void mark_files(Entry& entry, const SceneFiles& files);

  std::size_t capacity_;
  int threads_;
  Metrics& metrics_;
  LoadScene load_;
  std::optional<core::SceneStore> store_;
  std::list<Entry> recent_;  // most recent first
};

}  // namespace tessera::worker
