// SPDX-License-Identifier: Apache-2.0
// An on-disk cache of prepared scenes (files read, tree built), so that the next start only reads the
// result. The key of a scene depends on the contents of all its inputs and on the build. Entries that are
// unreadable or damaged are rebuilt. Processes of one user may share a folder; its contents are trusted.
// Thread-safe.
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

// Writes a scene in two steps: the inputs, which building consumes, then the tree.
class SceneWriter {
 public:
  SceneWriter(const SceneStore& store, BlockFileWriter file, const std::string& key,
              const SceneDescription& description);
  SceneWriter(SceneWriter&&) noexcept;
  SceneWriter& operator=(SceneWriter&&) noexcept;
  ~SceneWriter();

  // The scene can be found only after this call.
  void finish(const accel::Bvh& bvh);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// The input of build_scene: with a tree if it was cached, else with a writer if it should be cached.
struct PreparedScene {
  SceneDescription description;
  std::optional<accel::Bvh> bvh = {};
  std::optional<SceneWriter> writer = {};
};

// Calls Scene::build, and stores a new result.
Result<Scene> build_scene(PreparedScene prepared, int threads);

class SceneStore {
 public:
  using Warn = std::function<void(const std::string& message)>;

  // Creates the folder if it is missing, and rejects one that others can write to. Files for which
  // `is_counted` returns true take at most `max_bytes`, those that are being written included: before each
  // scene the least recently used are removed, which are stored scenes of any age and other files that were
  // not used for an hour. A scene for which there is no room then is not stored. `warn` receives non-fatal
  // errors.
  static Result<SceneStore> open(const std::string& folder, std::uint64_t max_bytes, Warn warn,
                                 IsName is_counted = is_file_name);

  // The scene with this key, or the result of `load`.
  Result<PreparedScene> prepare(std::string_view key, int threads,
                                const std::function<Result<SceneDescription>()>& load) const;

  // As load_scene_file(), but from the store if none of the files has changed. A scene that refers to
  // missing files is not stored.
  Result<PreparedScene> prepare_file(const std::string& scene_path, int threads) const;

  // Whether a file in the folder belongs to a store. Such files can be removed at any time, because readers
  // keep them open.
  static bool is_file_name(const std::string& name);

 private:
  friend SceneWriter;

  SceneStore(std::string folder, std::uint64_t max_bytes, Warn warn, IsName is_counted);

  std::string path_of(std::string_view key, std::string_view suffix) const;
  std::optional<PreparedScene> find(std::string_view key, int threads) const;
  std::optional<SceneWriter> begin(std::string_view key, const SceneDescription& description,
                                   int threads) const;
  void keep_list(const std::string& key, const stored::RecordedAssets& recorded, int threads) const;
  bool fits(std::uint64_t bytes) const;
  bool make_room() const;
  bool make_room_for(BlockFileWriter& file, std::uint64_t bytes) const;
  void warn_unless_missing(const Error& error) const;

  std::string folder_;
  std::uint64_t max_bytes_;
  Warn warn_;
  IsName is_counted_;
};

}  // namespace tessera::core
