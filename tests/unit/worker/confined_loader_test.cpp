// SPDX-License-Identifier: Apache-2.0
// Loading scenes in a process of its own, and what the worker makes of one that fails or was taken over.
#include "worker/confined_loader.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <thread>

#include "core/integrators/fingerprint.hpp"
#include "core/sandbox/confinement.hpp"
#include "core/sandbox/memory_file.hpp"
#include "core/sandbox/process.hpp"
#include "core/scene/cache/loaded_scene.hpp"
#include "core/scene/loader/loader.hpp"
#include "core/scene/scene.hpp"
#include "tests/support/bundle_files.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/sandbox/in_child.hpp"

namespace tessera::worker {
namespace {

using namespace std::chrono_literals;
using core::ErrorCode;
using testing::HasSubstr;

class ConfinedLoader : public testing::Test {
 protected:
  void add(const std::string& name, const std::string& bytes) {
    const std::string path = folder_.path() / ("blob" + std::to_string(files_.blob_paths.size()));
    write_file(path, bytes);
    files_.blob_paths[name] = path;
    files_.digests[name] = proto::digest_of(bytes);
  }
  void add_cornell() {
    for (const char* name : {"scene.json", "box.obj", "box.mtl"})
      add(name, read_file(std::filesystem::path(TESSERA_SOURCE_DIR) / "scenes/cornell" / name));
  }
  // A shell script in place of the loader.
  void replace_loader(const std::string& script) {
    const auto path = folder_.path() / "stand-in";
    write_file(path, "#!/bin/sh\n" + script + "\n");
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    options_.program = path;
  }
  // In place of the loader, what writes this.
  void replace_loader_by_one_that_writes(const core::SceneDescription& scene) {
    const std::string path = folder_.path() / "forged";
    EXPECT_TRUE(core::write_loaded(core::OpenFile(::open(path.c_str(), O_RDWR | O_CREAT, 0600)), scene));
    replace_loader("cat " + path);
  }
  core::Result<core::SceneDescription> load(const std::stop_token& stop = {}) {
    return load_confined(options_, files_, 2, stop);
  }
  core::Error error() {
    const auto loaded = load();
    EXPECT_FALSE(loaded);
    return loaded ? core::Error{} : loaded.error();
  }

  TemporaryFolder folder_;
  SceneFiles files_{.key = "key", .scene_path = "scene.json", .blob_paths = {}};
  LoaderOptions options_;
};

// The bytes in which a scene is passed on: all of it.
std::string bytes_of(const core::SceneDescription& scene) {
  const TemporaryFolder folder;
  const std::string path = folder.path() / "file";
  EXPECT_TRUE(core::write_loaded(core::OpenFile(::open(path.c_str(), O_RDWR | O_CREAT, 0600)), scene));
  return read_file(path);
}

TEST_F(ConfinedLoader, LoadsWhatIsLoadedHere) {
  add_cornell();
  auto assets = bundle_at(files_.blob_paths);
  const auto here = core::load_scene(assets, "scene.json", "scene.json"), there = load();
  ASSERT_TRUE(here && there) << there.error().message;
  EXPECT_TRUE(bytes_of(*there) == bytes_of(*here));
}

TEST_F(ConfinedLoader, SaysWhatIsSaidHere) {
  add("scene.json", "{\n \"spp\": }");
  add("unused", "");
  auto assets = bundle_at(files_.blob_paths);
  const auto here = core::load_scene(assets, "scene.json", "scene.json");
  const core::Error there = error();
  EXPECT_EQ(there.code, here.error().code);
  EXPECT_EQ(there.message, here.error().message);
}

// Whole images of every format, and broken ones: no decoder needs what confinement takes away.
TEST_F(ConfinedLoader, DecodesEveryFormatAsItIsDecodedHere) {
#ifdef TESSERA_SANITIZED
  GTEST_SKIP() << "sanitizers need what confinement takes away";
#endif
  const std::string scene = R"({"camera": {"position": [0, 0, 5], "look_at": [0, 0, 0]},
    "textures": {"t": {"file": "image"}}, "materials": {"m": {"type": "lambert", "albedo": {"texture": "t"}}},
    "environment": {"radiance": 1}, "shapes": [{"type": "sphere", "radius": 1, "material": "m"}]})";
  int decoded = 0;
  for (const auto& image :
       std::filesystem::directory_iterator(TESSERA_SOURCE_DIR "/tests/fuzz/corpus/image")) {
    SCOPED_TRACE(image.path());
    files_.blob_paths.clear();
    add("scene.json", scene);
    add("image", read_file(image.path()));
    auto assets = bundle_at(files_.blob_paths);
    const auto here = core::load_scene(assets, "scene.json", "scene.json"), there = load();
    ASSERT_EQ(there.has_value(), here.has_value()) << (here ? there : here).error().message;
    if (here) {
      EXPECT_TRUE(bytes_of(*there) == bytes_of(*here));
    } else {
      EXPECT_EQ(there.error().message, here.error().message);
    }
    decoded += here ? 1 : 0;
  }
  EXPECT_GT(decoded, 20);
}

// Looked at while it waits for the file of a scene.
TEST_F(ConfinedLoader, IsConfined) {
  if (sandbox::kIsSanitized) GTEST_SKIP() << "sanitizers need what confinement takes away";
  const auto in = sandbox::create_memory_file("in").value(), out = sandbox::create_memory_file("out").value();
  ASSERT_TRUE(core::write_load_request(core::OpenFile(dup(in.get())), {"scene.json", {"a", "scene.json"}}));
  int looks = 0;
  const auto look = [&](std::uint32_t number) -> core::Result<core::OpenFile> {
    ++looks;
    EXPECT_EQ(number, 1u);
    sandbox::expect_confined(sandbox::child(), "tessera-scene-loader");
    return core::fail(ErrorCode::kNotFound, "none");
  };
  const auto ending = sandbox::run({.path = options_.program, .timeout = 1min}, {in, out, look});
  ASSERT_TRUE(ending);
  EXPECT_TRUE(ending->succeeded());
  EXPECT_EQ(looks, 1);
}

TEST_F(ConfinedLoader, RemovesAFileThatHasChanged) {
  add_cornell();
  const std::string path = files_.blob_paths.at("box.obj");
  write_file(path, read_file(path) + "\n");
  const core::Error changed = error();
  EXPECT_EQ(changed.code, ErrorCode::kDataLoss);
  EXPECT_EQ(changed.message, path + " has changed since it was fetched");
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_THAT(error().message, HasSubstr("'box.obj' does not exist"));
}

TEST_F(ConfinedLoader, NamesTheLimitOfMemory) {
  if (sandbox::kIsSanitized) GTEST_SKIP() << "sanitizers need addresses without limit";
  add("scene.json", R"({"camera": {"position": [0, 0, 5], "look_at": [0, 0, 0]},
    "materials": {"m": {"type": "lambert"}}, "shapes": [{"type": "mesh", "material": "m", "file": "big.obj"}]})");
  add("big.obj", std::string(std::size_t{200} << 20, '\n'));
  options_.memory_mib = 150;
  const core::Error too_big = error();
  EXPECT_EQ(too_big.code, ErrorCode::kResourceExhausted);
  EXPECT_THAT(too_big.message, HasSubstr("does not fit into memory; this worker loads scenes within 150 MiB "
                                         "(tessera-worker --scene-mib)"));
}

TEST_F(ConfinedLoader, TheEndOfTheProcessIsExplained) {
  add("scene.json", "{}");
  const struct {
    std::string script;
    ErrorCode code;
    std::string sentence;
  } ends[] = {{"kill -SEGV $$", ErrorCode::kInternal,
               "the scene could not be loaded: tessera-scene-loader ended by signal 11"},
              {"kill -SYS $$", ErrorCode::kInternal, "the sandbox forbids it"},
              {"exit 1", ErrorCode::kInternal, "tessera-scene-loader ended with status 1"},
              {"kill -KILL $$", ErrorCode::kResourceExhausted, "the scene does not fit into memory"},
              {"kill -XFSZ $$", ErrorCode::kResourceExhausted, "the scene does not fit into memory"},
              {"exit 3", ErrorCode::kResourceExhausted, "the scene does not fit into memory"},
              {"kill -XCPU $$", ErrorCode::kDeadlineExceeded, "within the 1200 s that this worker allows"},
              {"exit 0", ErrorCode::kInternal, "has written what no scene is"},
              {"echo a scene", ErrorCode::kInternal, "has written what no scene is"}};
  for (const auto& end : ends) {
    replace_loader(end.script);
    const core::Error told = error();
    EXPECT_EQ(told.code, end.code) << end.script;
    EXPECT_THAT(told.message, HasSubstr(end.sentence)) << end.script;
  }
  options_.program = folder_.path() / "none";
  EXPECT_THAT(error().message, HasSubstr("none: No such file or directory"));
}

TEST_F(ConfinedLoader, HasSoMuchTime) {
  add("scene.json", "{}");
  replace_loader("exec sleep 600");
  options_.time = 1s;
  const core::Error late = error();
  EXPECT_EQ(late.code, ErrorCode::kDeadlineExceeded);
  EXPECT_EQ(
      late.message,
      "the scene was not loaded within the 1 s that this worker allows (tessera-worker --scene-seconds)");
}

TEST_F(ConfinedLoader, EndsWithTheWorker) {
  add("scene.json", "{}");
  replace_loader("exec sleep 600");
  std::stop_source stopping;
  std::jthread stopper([&] { stopping.request_stop(); });
  const auto loaded = load(stopping.get_token());
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().code, ErrorCode::kCancelled);
}

TEST_F(ConfinedLoader, IsToldItsLimits) {
  add("scene.json", "{}");
  replace_loader("echo \"$@\" > " + (folder_.path() / "told").string());
  options_.memory_mib = 444;
  options_.time = 55s;
  options_.require_sandbox = true;
  error();
  EXPECT_THAT(read_file(folder_.path() / "told"),
              testing::StartsWith("--scene-mib 444 --scene-seconds 55 --require-sandbox --parent "));
}

// Whatever a process writes that was taken over, the worker builds a scene or refuses it.
TEST_F(ConfinedLoader, IsNotTrusted) {
  add("scene.json", "{}");
  core::SceneDescription scene = core::integrators::fingerprint_scene();
  replace_loader_by_one_that_writes(scene);
  const auto loaded = load();
  ASSERT_TRUE(loaded);
  EXPECT_TRUE(bytes_of(*loaded) == bytes_of(scene));

  scene.materials.at(0).emission.texture = 1 << 30;
  scene.materials.at(0).name = "\x1b[2J";
  replace_loader_by_one_that_writes(scene);
  auto forged = load();
  ASSERT_TRUE(forged);
  EXPECT_FALSE(core::Scene::build(std::move(*forged), 1));

  scene.settings.integrator = static_cast<core::Integrator>(77);
  replace_loader_by_one_that_writes(scene);
  EXPECT_THAT(error().message, HasSubstr("has written what no scene is"));
}

}  // namespace
}  // namespace tessera::worker
