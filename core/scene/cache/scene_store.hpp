// SPDX-License-Identifier: Apache-2.0
// Scenes on this machine's disk as they are once their files are read and their tree is built, so that the
// next start takes as long as reading them. A scene is kept under a key made of the contents of all that it
// was made of and of who made it. What cannot be read, or is not exactly what was written, is made anew.
// Processes may share a folder, but only those of one user: what is found there is believed. Thread-safe.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "core/scene/cache/block_file.hpp"
#include "core/scene/cache/cache_folder.hpp"
#include "core/scene/scene.hpp"

namespace tessera::core {

namespace stored {
class RecordedAssets;
}

inline constexpr double kDefaultSceneCacheGib = 16;

class SceneStore;

// Writes a scene in two steps: what it is made of, which building consumes, then the tree.
class SceneWriter {
 public:
  SceneWriter(const SceneStore& store, BlockFileWriter file, const std::string& key,
              const SceneDescription& description);
  SceneWriter(SceneWriter&&) noexcept;
  SceneWriter& operator=(SceneWriter&&) noexcept;
  ~SceneWriter();

  // Only after this can the scene be found.
  void finish(const Bvh& bvh);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// What is to be built: with a tree if it was kept, else with a writer where it is to be kept.
struct PreparedScene {
  SceneDescription description;
  std::optional<Bvh> bvh = {};
  std::optional<SceneWriter> writer = {};
};

// Scene::build, and keeps the result if it is new.
Result<Scene> build_scene(PreparedScene prepared, int threads);

class SceneStore {
 public:
  using Warn = std::function<void(const std::string& message)>;

  // Creates the folder where it is missing, and refuses one that others can write to. After each scene the
  // least used of the files that `is_counted` knows are removed, as remove_least_used() does, and a scene
  // that takes more than `max_bytes` is not kept; `warn` is told what went wrong without doing harm.
  static Result<SceneStore> open(const std::string& folder, std::uint64_t max_bytes, Warn warn,
                                 IsName is_counted = is_file_name);

  // The scene whose files have this key, or what `load` makes of them.
  Result<PreparedScene> prepare(std::string_view key, int threads,
                                const std::function<Result<SceneDescription>()>& load) const;

  // As load_scene_file(), from the store where none of the files that it read has changed since. A
  // scene that names files which are not there by these names is not kept.
  Result<PreparedScene> prepare_file(const std::string& scene_path, int threads) const;

  // Whether a file in the folder belongs to a store. Such files can be removed at any time: whoever reads one
  // has it open.
  static bool is_file_name(const std::string& name);

 private:
  friend SceneWriter;

  SceneStore(std::string folder, std::uint64_t max_bytes, Warn warn, IsName is_counted);

  std::string path_of(std::string_view key, std::string_view suffix) const;
  std::optional<PreparedScene> find(std::string_view key, int threads) const;
  std::optional<SceneWriter> begin(std::string_view key, const SceneDescription& description,
                                   int threads) const;
  void keep_list(const std::string& key, const stored::RecordedAssets& recorded, int threads) const;
  bool has_room_for(std::uint64_t bytes) const;
  void warn_unless_missing(const Error& error) const;

  std::string folder_;
  std::uint64_t max_bytes_;
  Warn warn_;
  IsName is_counted_;
};

}  // namespace tessera::core
