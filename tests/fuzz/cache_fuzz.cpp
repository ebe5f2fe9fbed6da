// SPDX-License-Identifier: Apache-2.0
// A file of the cache of built scenes: one that a scene was kept in, changed by the input's parts. "patch"
// puts bytes at the place that its first four bytes say, "cut" leaves as many bytes as it has itself. What is
// no longer what was written is not read. A part named "index" takes the place of all values in the file,
// under checksums that are in order: the reader takes it or refuses it.
#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>

#include "core/scene/cache/archive.hpp"
#include "core/scene/cache/scene_maker.hpp"
#include "core/scene/cache/scene_store.hpp"
#include "tests/fuzz/expect.hpp"
#include "tests/fuzz/fuzzer.hpp"
#include "tests/fuzz/parts.hpp"
#include "tests/fuzz/scratch_folder.hpp"

namespace tessera::fuzz::cache_fuzz {
namespace {

namespace fs = std::filesystem;

const std::string kKey = "key";

core::SceneDescription small_scene() {
  core::SceneDescription scene;
  scene.camera.look_at = {0, 0, -1};
  scene.materials.emplace_back();
  scene.shapes.push_back(core::QuadDescription{{0, 0, -1}, {1, 0, 0}, {0, 1, 0}, 0});
  scene.shape_names.push_back("shapes[0]");
  scene.environment.emplace();
  return scene;
}

core::SceneStore open_store(const fs::path& folder) {
  auto store =
      core::SceneStore::open(folder, UINT64_MAX, [](const std::string& why) { expect_message(why); });
  expect(store.has_value(), "a folder of one's own is a cache");
  return std::move(*store);
}

std::string read(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// The folder of a cache with one scene in it.
struct Cache {
  fs::path folder = scratch_folder() / "cache";
  fs::path file;
  std::string written;

  Cache() {
    auto prepared = open_store(folder).prepare(kKey, 1, small_scene);
    expect(prepared && core::build_scene(std::move(*prepared), 1), "a scene can be built and kept");
    file = fs::directory_iterator(folder)->path();
    written = read(file);
  }
};

void patch(std::string& bytes, std::string_view change) {
  std::uint32_t at = 0;
  const std::size_t size = std::min(sizeof at, change.size());
  std::memcpy(&at, change.data(), size);
  change.remove_prefix(size);
  if (!bytes.empty()) at %= static_cast<std::uint32_t>(bytes.size());
  bytes.replace(std::min<std::size_t>(at, bytes.size()), change.size(), change);
}

// A file that the store will believe, with these values behind the key.
void write_index(const fs::path& file, std::string_view values) {
  const auto version = core::checksum_of(std::as_bytes(std::span(core::stored::scene_maker())));
  auto blocks = core::BlockFileWriter::create(file, version, 1);
  expect(blocks.has_value(), "a file can be written");
  core::stored::Writer writer(*blocks);
  writer(kKey);
  std::vector<std::byte> index = writer.bytes();
  const auto rest = std::as_bytes(std::span(values));
  index.insert(index.end(), rest.begin(), rest.end());
  expect(blocks->finish(index).has_value(), "a file can be written");
}

void change_and_find(std::string_view input) {
  static const Cache cache;
  std::string bytes = cache.written;
  bool trusted = false;
  for (const Part& part : parts_of(input)) {
    if (part.name == "patch") patch(bytes, part.bytes);
    if (part.name == "cut") bytes.resize(std::min(bytes.size(), part.bytes.size()));
    trusted = trusted || part.name == "index";
    if (part.name == "index") write_index(cache.file, part.bytes);
  }
  if (!trusted) std::ofstream(cache.file, std::ios::binary) << bytes;
  bool loaded_anew = false;
  const auto load = [&]() -> core::Result<core::SceneDescription> {
    loaded_anew = true;
    return core::fail(core::ErrorCode::kNotFound, "it is not there");
  };
  const auto prepared = open_store(cache.folder).prepare(kKey, 1, load);
  expect_answer(prepared);
  if (!trusted) expect(loaded_anew == (bytes != cache.written), "a file is read if it is what was written");
}

}  // namespace

TESSERA_FUZZER(cache, std::string_view input) {
  change_and_find(input);
}

}  // namespace tessera::fuzz::cache_fuzz
