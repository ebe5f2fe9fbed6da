// The scenes rendered last, built and ready. For the render thread alone: building uses its threads.
#pragma once

#include <chrono>
#include <list>
#include <memory>
#include <string>

#include "core/base/error.hpp"
#include "core/scene/scene.hpp"
#include "worker/job.hpp"

namespace tessera::worker {

class SceneCache {
 public:
  SceneCache(std::size_t capacity, int threads) : capacity_(capacity), threads_(threads) {}

  // Loads and builds the scene if it is not here, and counts its files as used. Errors are those of
  // load_scene and Scene::build.
  core::Result<std::shared_ptr<const core::Scene>> get(const SceneFiles& files);

 private:
  using Clock = std::chrono::steady_clock;
  struct Entry {
    std::string key;
    std::shared_ptr<const core::Scene> scene;
    Clock::time_point files_marked;
  };

  static void mark_files(Entry& entry, const SceneFiles& files);

  std::size_t capacity_;
  int threads_;
  std::list<Entry> recent_;  // latest first
};

}  // namespace tessera::worker
