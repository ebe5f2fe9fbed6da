#include "core/scene/cache/scene_store.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <new>
#include <span>
#include <utility>

#include "core/scene/cache/archive.hpp"
#include "core/scene/cache/cache_folder.hpp"
#include "core/scene/cache/source_files.hpp"
#include "core/scene/loader/loader.hpp"

namespace tessera::core {
namespace stored {

auto fields(Is<SourceFile> auto& value) {
  auto& [path, is_there, checksum] = value;
  auto& [low, high] = checksum;
  return std::tie(path, is_there, low, high);
}

}  // namespace stored

namespace {

namespace fs = std::filesystem;
using stored::SourceFiles;

constexpr std::size_t kHexDigits = 32;
constexpr std::string_view kSceneSuffix = ".scene", kFilesSuffix = ".files", kPartialSuffix = ".partial";

std::string hex_of(std::string_view text) {
  return to_hex(checksum_of(std::as_bytes(std::span(text))));
}

// What one file of the store holds; kDataLoss where it does not.
template <typename Value>
Result<Value> read_value(const std::string& path, int threads) {
  auto file = BlockFileReader::open(path, kSceneFileVersion, threads);
  if (!file) return fail(file.error());
  Value value;
  stored::Reader reader(*file);
  reader(value);
  if (!reader.complete()) return fail(ErrorCode::kDataLoss, path + " is damaged");
  return value;
}

struct StoredScene {
  SceneDescription description;
  Bvh::Arrays tree;
};
auto fields(stored::Is<StoredScene> auto& value) {
  auto& [description, tree] = value;
  return std::tie(description, tree);
}

}  // namespace

struct SceneWriter::State {
  SceneStore store;
  BlockFileWriter file;
  stored::Writer writer;

  State(SceneStore of, BlockFileWriter to) : store(std::move(of)), file(std::move(to)), writer(file) {}
};

SceneWriter::SceneWriter(const SceneStore& store, BlockFileWriter file, const SceneDescription& description)
    : state_(std::make_unique<State>(store, std::move(file))) {
  state_->writer(description);
}
SceneWriter::SceneWriter(SceneWriter&&) noexcept = default;
SceneWriter& SceneWriter::operator=(SceneWriter&&) noexcept = default;
SceneWriter::~SceneWriter() = default;

void SceneWriter::finish(const Bvh& bvh) {
  const SceneStore& store = state_->store;
  state_->writer(bvh.arrays());
  const Status written = state_->file.finish(state_->writer.bytes());
  if (!written) store.warn_unless_missing(written.error());
  remove_least_used(store.folder_, store.max_bytes_, store.is_counted_);
}

SceneStore::SceneStore(std::string folder, std::uint64_t max_bytes, Warn warn, IsCounted is_counted)
    : folder_(std::move(folder)),
      max_bytes_(max_bytes),
      warn_(std::move(warn)),
      is_counted_(std::move(is_counted)) {}

Result<SceneStore> SceneStore::open(const std::string& folder, std::uint64_t max_bytes, Warn warn,
                                    IsCounted is_counted) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    return fail(ErrorCode::kUnavailable, fmt::format("cannot create {}: {}", folder, error.message()));
  if (::access(folder.c_str(), R_OK | W_OK | X_OK) != 0)
    return fail(ErrorCode::kPermissionDenied,
                fmt::format("cannot write to {}: {}", folder, std::strerror(errno)));
  remove_abandoned(folder, [](const std::string& name) {
    return name.ends_with(kPartialSuffix) && is_file_name(name.substr(0, name.find('.', kHexDigits + 1)));
  });
  return SceneStore(folder, max_bytes, std::move(warn), std::move(is_counted));
}

bool SceneStore::is_file_name(const std::string& name) {
  const std::string_view suffix = std::string_view(name).substr(std::min(kHexDigits, name.size()));
  return name.find_first_not_of("0123456789abcdef") == kHexDigits &&
         (suffix == kSceneSuffix || suffix == kFilesSuffix);
}

std::string SceneStore::path_of(std::string_view key, std::string_view suffix) const {
  return fmt::format("{}/{}{}", folder_, hex_of(key), suffix);
}

void SceneStore::warn_unless_missing(const Error& error) const {
  if (error.code != ErrorCode::kNotFound) warn_("the scene cache is of no use here: " + error.message);
}

std::optional<PreparedScene> SceneStore::find(std::string_view key, int threads) const {
  const std::string path = path_of(key, kSceneSuffix);
  auto scene = read_value<StoredScene>(path, threads);
  if (!scene) {
    warn_unless_missing(scene.error());
    return std::nullopt;
  }
  mark_as_used(path);
  return PreparedScene{std::move(scene->description), Bvh(std::move(scene->tree))};
}

std::optional<SceneWriter> SceneStore::begin(std::string_view key, const SceneDescription& description,
                                             int threads) const {
  auto file = BlockFileWriter::create(path_of(key, kSceneSuffix), kSceneFileVersion, threads);
  if (file) return SceneWriter(*this, std::move(*file), description);
  warn_unless_missing(file.error());
  return std::nullopt;
}

Result<PreparedScene> SceneStore::prepare(std::string_view key, int threads,
                                          const std::function<Result<SceneDescription>()>& load) const {
  if (auto found = find(key, threads)) return std::move(*found);
  auto description = load();
  if (!description) return fail(description.error());
  PreparedScene prepared{std::move(*description)};
  prepared.writer = begin(key, prepared.description, threads);
  return prepared;
}

// Which files a scene is made of is known when it has been read. They are listed under the scene file's own
// contents, for the next time.
Result<PreparedScene> SceneStore::prepare_file(const std::string& scene_path, int threads) const {
  const fs::path path(scene_path);
  const std::string folder = path.parent_path(), name = path.filename();
  const auto own = stored::checksum_of_file(scene_path, threads);
  const std::string list_path = path_of(fmt::format("{} {}", name, own ? to_hex(*own) : ""), kFilesSuffix);
  const auto listed = read_value<SourceFiles>(list_path, threads);
  if (!listed) warn_unless_missing(listed.error());
  if (listed) {
    if (auto found = find(key_of(as_they_are(*listed, folder, threads)), threads)) {
      mark_as_used(list_path);
      return std::move(*found);
    }
  }
  FolderAssets assets(folder);
  stored::RecordedAssets recorded(assets, threads);
  auto description = load_scene(recorded, name, scene_path);
  if (!description) return fail(description.error());
  PreparedScene prepared{std::move(*description)};
  auto list = BlockFileWriter::create(list_path, kSceneFileVersion, threads);
  if (!list) {
    warn_unless_missing(list.error());
    return prepared;
  }
  stored::Writer writer(*list);
  writer(recorded.files());
  if (Status written = list->finish(writer.bytes()); !written) warn_unless_missing(written.error());
  prepared.writer = begin(key_of(recorded.files()), prepared.description, threads);
  return prepared;
}

Result<Scene> build_scene(PreparedScene prepared, int threads) {
  auto scene = Scene::build(std::move(prepared.description), threads, std::move(prepared.bvh));
  if (scene && prepared.writer) prepared.writer->finish(scene->bvh());
  return scene;
}

}  // namespace tessera::core
