// SPDX-License-Identifier: Apache-2.0
// What a process writes that loads scenes for a worker and was taken over: a scene with something of
// everything, changed by the input's parts, under checksums that are in order. "index" and "block" put bytes
// at the place that their first four bytes say: among the values, or in the large arrays. "cut" leaves as
// many bytes of the values as it has itself. The worker refuses the scene, or builds and renders it; with
// "paths" in the first part it traces paths.
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <new>
#include <vector>

#include "core/integrators/fingerprint.hpp"
#include "core/scene/cache/archive.hpp"
#include "core/scene/cache/loaded_scene.hpp"
#include "core/scene/cache/scene_maker.hpp"
#include "core/scene/scene.hpp"
#include "tests/fuzz/expect.hpp"
#include "tests/fuzz/fuzzer.hpp"
#include "tests/fuzz/parts.hpp"
#include "tests/fuzz/render_corner.hpp"

namespace tessera::fuzz::loaded_fuzz {
namespace {

struct Written {
  std::vector<std::byte> index;
  std::vector<std::vector<std::byte>> blocks;

  // As a sink of blocks.
  void write_block(std::span<const std::byte> block) { blocks.emplace_back(block.begin(), block.end()); }
};

Written write_scene() {
  Written written;
  core::stored::Writer writer(written);
  writer(true);
  writer(core::integrators::fingerprint_scene());
  written.index = writer.bytes();
  return written;
}

void patch(std::vector<std::byte>& bytes, std::string_view change) {
  std::uint32_t at = 0;
  const std::size_t size = std::min(sizeof at, change.size());
  std::memcpy(&at, change.data(), size);
  change.remove_prefix(size);
  if (bytes.empty()) return;
  at %= static_cast<std::uint32_t>(bytes.size());
  std::memcpy(bytes.data() + at, change.data(), std::min(change.size(), bytes.size() - at));
}

core::OpenFile file_of(const Written& written) {
  core::OpenFile file(::memfd_create("loaded", MFD_CLOEXEC));
  expect(file.valid(), "a file can be created");
  auto out =
      core::BlockFileWriter::to(core::OpenFile(::dup(file.get())), "", core::stored::file_version(), 1);
  for (const auto& block : written.blocks) out.write_block(block);
  expect(out.finish(written.index).has_value(), "a file can be written");
  return file;
}

void build_and_render(core::SceneDescription description, core::Integrator integrator) {
  auto scene = core::Scene::build(std::move(description), 1);
  if (!scene) return expect(!scene.error().message.empty(), "an error says what is wrong");
  const core::RenderSettings settings{.integrator = integrator};  // a worker takes those of the job
  for (const std::int32_t frame : {0, 7}) {
    if (const core::Status shown = scene->set_frame(frame, 1); !shown)
      return expect(!shown.error().message.empty(), "an error says what is wrong");
    render_corner(*scene, settings);
  }
}

void change_and_read(std::string_view input) {
  static const Written scene = write_scene();
  Written changed = scene;
  const std::vector<Part> parts = parts_of(input);
  for (const Part& part : parts) {
    if (part.name == "index") patch(changed.index, part.bytes);
    if (part.name == "block" && !changed.blocks.empty()) patch(changed.blocks.front(), part.bytes);
    if (part.name == "cut") changed.index.resize(std::min(changed.index.size(), part.bytes.size()));
  }
  auto read = core::read_loaded(file_of(changed), 1);
  if (!expect_answer(read)) return;
  const bool paths = parts.front().bytes == "paths";
  build_and_render(std::move(*read), paths ? core::Integrator::kMis : core::Integrator::kWhitted);
}

}  // namespace

TESSERA_FUZZER(loaded, std::string_view input) {
  change_and_read(input);
}

}  // namespace tessera::fuzz::loaded_fuzz
