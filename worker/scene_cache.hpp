// The scenes rendered last, built and ready. For the render thread alone: building uses its threads.
#pragma once

#include <list>
#include <memory>
#include <string>
#include <utility>

#include "core/base/error.hpp"
#include "core/scene/scene.hpp"
#include "worker/job.hpp"

namespace tessera::worker {

class SceneCache {
 public:
  SceneCache(std::size_t capacity, int threads) : capacity_(capacity), threads_(threads) {}

  // Loads and builds the scene if it is not here. Errors are those of load_scene and Scene::build.
  core::Result<std::shared_ptr<const core::Scene>> get(const SceneFiles& files);

 private:
  std::size_t capacity_;
  int threads_;
  std::list<std::pair<std::string, std::shared_ptr<const core::Scene>>> recent_;  // by key, latest first
};

}  // namespace tessera::worker
