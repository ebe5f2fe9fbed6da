// SPDX-License-Identifier: Apache-2.0
#include "core/scene/cache/scene_store.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <exception>
#include <filesystem>
#include <span>
#include <utility>

#include "core/scene/cache/archive.hpp"
#include "core/scene/cache/cache_folder.hpp"
#include "core/scene/cache/scene_maker.hpp"
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
constexpr std::string_view kSceneSuffix = ".scene", kFilesSuffix = ".files";

std::string hex_of(std::string_view text) {
  return to_hex(checksum_of(std::as_bytes(std::span(text))));
}

// Reads the value stored under this key; kDataLoss if the file does not contain it.
template <typename Value>
Result<Value> read_value(const std::string& path, std::string_view key, int threads) try {
  auto file = BlockFileReader::open(path, stored::file_version(), threads);
  if (!file) return fail(file.error());
  std::string key_of_file;
  Value value;
  stored::Reader reader(*file);
  reader(key_of_file);
  reader(value);
  if (!reader.complete()) return fail(ErrorCode::kDataLoss, path + " is damaged");
  if (key_of_file != key) return fail(ErrorCode::kDataLoss, path + " is of something else");
  return value;
} catch (const std::exception& error) {
  return fail(ErrorCode::kDataLoss, fmt::format("{} cannot be read: {}", path, error.what()));
}

struct StoredScene {
  SceneDescription description;
  accel::Bvh::Arrays tree;
};
auto fields(stored::Is<StoredScene> auto& value) {
  auto& [description, tree] = value;
  return std::tie(description, tree);
}

}  // namespace

struct SceneWriter::State {
  SceneStore store;
  BlockFileWriter file;
  stored::Writer<BlockFileWriter> writer;
  std::uint64_t bytes;

  State(SceneStore of, BlockFileWriter to, std::uint64_t bytes_of_description)
      : store(std::move(of)), file(std::move(to)), writer(file), bytes(bytes_of_description) {}
};

SceneWriter::SceneWriter(const SceneStore& store, BlockFileWriter file, const std::string& key,
                         const SceneDescription& description)
    : state_(std::make_unique<State>(store, std::move(file), stored::stored_bytes(description))) {
  state_->writer(key);
  state_->writer(description);
}
SceneWriter::SceneWriter(SceneWriter&&) noexcept = default;
SceneWriter& SceneWriter::operator=(SceneWriter&&) noexcept = default;
SceneWriter::~SceneWriter() = default;

void SceneWriter::finish(const accel::Bvh& bvh) {
  const SceneStore& store = state_->store;
  const std::uint64_t bytes = state_->bytes + stored::stored_bytes(bvh.arrays());
  if (!store.fits(bytes) || !store.make_room_for(state_->file, bytes)) return state_.reset();
  state_->writer(bvh.arrays());
  const Status written = state_->file.finish(state_->writer.bytes());
  if (!written) store.warn_unless_missing(written.error());
  store.make_room();  // for the checksums
}

SceneStore::SceneStore(std::string folder, std::uint64_t max_bytes, Warn warn, IsName is_counted)
    : folder_(std::move(folder)),
      max_bytes_(max_bytes),
      warn_(std::move(warn)),
      is_counted_(std::move(is_counted)) {}

Result<SceneStore> SceneStore::open(const std::string& folder, std::uint64_t max_bytes, Warn warn,
                                    IsName is_counted) {
  if (Status usable = make_folder(folder); !usable) return fail(usable.error());
  if (Status own = check_is_own(folder); !own) return fail(own.error());
  remove_abandoned(folder, is_file_name);
  return SceneStore(folder, max_bytes, std::move(warn), std::move(is_counted));
}

bool SceneStore::is_file_name(const std::string& name) {
  const std::string_view suffix = std::string_view(name).substr(std::min(kHexDigits, name.size()));
  return name.find_first_not_of("0123456789abcdef") == kHexDigits &&
         (suffix == kSceneSuffix || suffix == kFilesSuffix);
}

std::string SceneStore::path_of(std::string_view key, std::string_view suffix) const {
  return fmt::format("{}/{}{}", folder_, hex_of(fmt::format("{} {}", stored::scene_maker(), key)), suffix);
}

bool SceneStore::fits(std::uint64_t bytes) const {
  if (bytes <= max_bytes_) return true;
  constexpr double kMib = 1 << 20;
  warn_(fmt::format("a scene of {:.2f} MiB is not kept: the scene cache may have no more than {:.2f}",
                    static_cast<double>(bytes) / kMib, static_cast<double>(max_bytes_) / kMib));
  return false;
}

// Removes files until the rest is within the limit. Returns false if too much must stay.
bool SceneStore::make_room() const {
  const auto must_stay = [](const std::string& name, std::chrono::seconds unused_for) {
    return !is_file_name(name) && unused_for < kMayBeInUse;
  };
  return remove_least_used(folder_, max_bytes_, is_counted_, must_stay) <= max_bytes_;
}

// Several writers at a time, also of other processes, count each other's files before there is a byte in
// them.
bool SceneStore::make_room_for(BlockFileWriter& file, std::uint64_t bytes) const {
  file.reserve(bytes);
  return make_room();
}

void SceneStore::warn_unless_missing(const Error& error) const {
  if (error.code != ErrorCode::kNotFound) warn_("the scene cache is of no use here: " + error.message);
}

std::optional<PreparedScene> SceneStore::find(std::string_view key, int threads) const {
  const std::string path = path_of(key, kSceneSuffix);
  auto scene = read_value<StoredScene>(path, key, threads);
  if (!scene) {
    warn_unless_missing(scene.error());
    return std::nullopt;
  }
  mark_as_used(path);
  return PreparedScene{std::move(scene->description), accel::Bvh(std::move(scene->tree))};
}

std::optional<SceneWriter> SceneStore::begin(std::string_view key, const SceneDescription& description,
                                             int threads) const {
  const std::uint64_t bytes = stored::stored_bytes(description);
  if (!fits(bytes)) return std::nullopt;
  auto file = BlockFileWriter::create(path_of(key, kSceneSuffix), stored::file_version(), threads);
  if (!file) {
    warn_unless_missing(file.error());
    return std::nullopt;
  }
  if (!make_room_for(*file, bytes)) return std::nullopt;
  return SceneWriter(*this, std::move(*file), std::string(key), description);
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

void SceneStore::keep_list(const std::string& key, const stored::RecordedAssets& recorded,
                           int threads) const {
  auto list = BlockFileWriter::create(path_of(key, kFilesSuffix), stored::file_version(), threads);
  if (!list) return warn_unless_missing(list.error());
  stored::Writer writer(*list);
  writer(key);
  writer(recorded.files());
  if (Status written = list->finish(writer.bytes()); !written) warn_unless_missing(written.error());
}

// The files of a scene are known only after it has been read. Their list is stored under the checksum of
// the scene file, for the next start.
Result<PreparedScene> SceneStore::prepare_file(const std::string& scene_path, int threads) const {
  const fs::path path(scene_path);
  const std::string folder = path.parent_path(), name = path.filename();
  const auto own = stored::checksum_of_file(scene_path, threads);
  const std::string list_key = fmt::format("{} {}", name, own ? to_hex(*own) : "");
  const std::string list_path = path_of(list_key, kFilesSuffix);
  const auto listed = read_value<SourceFiles>(list_path, list_key, threads);
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
  if (!recorded.consistent()) {
    warn_("files of the scene have changed while they were read: it is not kept");
    return prepared;
  }
  if (recorded.has_searched()) return prepared;
  prepared.writer = begin(key_of(recorded.files()), prepared.description, threads);
  if (prepared.writer) keep_list(list_key, recorded, threads);
  return prepared;
}

Result<Scene> build_scene(PreparedScene prepared, int threads) {
  auto scene = Scene::build(std::move(prepared.description), threads, std::move(prepared.bvh));
  if (scene && prepared.writer) prepared.writer->finish(scene->bvh());
  return scene;
}

}  // namespace tessera::core
