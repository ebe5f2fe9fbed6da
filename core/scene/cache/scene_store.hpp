// Scenes on this machine's disk as they are once their files are read and their tree is built, so that the
// next start takes as long as reading them. A scene is kept under a key made of the contents of all that it
// was made of. What cannot be read, or is not exactly what was written, is made anew. Processes may share a
// folder. Thread-safe.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "core/scene/cache/block_file.hpp"
#include "core/scene/scene.hpp"

namespace tessera::core {

// Of the files below, and of what they hold: to be raised whenever a loader or builder makes something else
// of the same files, or a type that is stored changes.
inline constexpr std::uint32_t kSceneFileVersion = 2;

inline constexpr double kDefaultSceneCacheGib = 16;

class SceneStore;

// Writes a scene in two steps: what it is made of, which building consumes, then the tree.
class SceneWriter {
 public:
  SceneWriter(const SceneStore& store, BlockFileWriter file, const SceneDescription& description);
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
  using IsCounted = std::function<bool(const std::string& file_name)>;

  // Creates the folder where it is missing. After each scene the least used of the files that `is_counted`
  // knows are removed, as remove_least_used() does; `warn` is told what went wrong without doing harm.
  static Result<SceneStore> open(const std::string& folder, std::uint64_t max_bytes, Warn warn,
                                 IsCounted is_counted = is_file_name);

  // The scene whose files have this key, or what `load` makes of them.
  Result<PreparedScene> prepare(std::string_view key, int threads,
                                const std::function<Result<SceneDescription>()>& load) const;

  // As load_scene_file(), from the store where none of the files that it read has changed since.
  Result<PreparedScene> prepare_file(const std::string& scene_path, int threads) const;

  // Whether a file in the folder belongs to a store.
  static bool is_file_name(const std::string& name);

 private:
  friend SceneWriter;

  SceneStore(std::string folder, std::uint64_t max_bytes, Warn warn, IsCounted is_counted);

  std::string path_of(std::string_view key, std::string_view suffix) const;
  std::optional<PreparedScene> find(std::string_view key, int threads) const;
  std::optional<SceneWriter> begin(std::string_view key, const SceneDescription& description,
                                   int threads) const;
  void warn_unless_missing(const Error& error) const;

  std::string folder_;
  std::uint64_t max_bytes_;
  Warn warn_;
  IsCounted is_counted_;
};

}  // namespace tessera::core
