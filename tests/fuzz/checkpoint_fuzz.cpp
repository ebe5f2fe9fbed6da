// SPDX-License-Identifier: Apache-2.0
// The checkpoint of a render, changed by the input's parts. "index", "tail" and "block" put bytes at the
// place that their first four bytes say: among the values, among the last of them, or in the sums; "cut"
// leaves as many bytes of the values as it has itself. All this under checksums that are in order. "file"
// changes the file itself, which is then refused. What is not refused is a film of this render.
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <vector>

#include "client/render_checkpoint.hpp"
#include "tests/fuzz/expect.hpp"
#include "tests/fuzz/fuzzer.hpp"
#include "tests/fuzz/parts.hpp"
#include "tests/fuzz/scratch_folder.hpp"

namespace tessera::fuzz::checkpoint_fuzz {
namespace {

// One tile, whose sums are one block of the file.
constexpr core::PixelRect kImage{0, 0, 64, 8};
constexpr std::uint32_t kSpp = 6;
constexpr std::size_t kTailBytes = 32;

client::RenderIdentity identity() {
  return client::identity_of({.width_px = kImage.x1, .height_px = kImage.y1, .spp = kSpp}, {});
}

struct Original {
  std::vector<std::byte> index, block;
  std::string file;

  Original() {
    client::SharedFilm film(core::TileGrid(kImage, core::kTilePx));
    core::FilmTile tile(kImage, {0, kSpp - 1});
    for (std::size_t i = 0; i < tile.sums.size(); ++i) tile.sums[i] = (i * 0x9e3779b9u) % 0xffffffffu;
    for (std::size_t i = 0; i < tile.sums.size(); ++i) tile.odd_sums[i] = tile.sums[i] / 2;
    tile.counters.samples = kImage.pixel_count() * tile.range.count();
    film.add(tile, {tile.counters, 1, 2}, {});
    const std::string path = (scratch_folder() / "checkpoint").string();
    expect(client::write_checkpoint(path, identity(), film).has_value(), "a checkpoint can be written");
    auto reader = core::BlockFileReader::open(path, client::checkpoint_format(), 1);
    expect(reader.has_value(), "a checkpoint can be read");
    index.assign(reader->index().begin(), reader->index().end());
    block.resize(reader->bytes_left());
    expect(reader->read_block(block), "the sums are one block");
    std::ifstream in(path, std::ios::binary);
    file.assign(std::istreambuf_iterator<char>(in), {});
  }
};

template <typename Bytes>
void put(Bytes& bytes, std::size_t from, std::string_view change) {
  std::uint32_t at = 0;
  const std::size_t size = std::min(sizeof at, change.size());
  std::memcpy(&at, change.data(), size);
  change.remove_prefix(size);
  if (bytes.size() <= from) return;
  const std::size_t to = from + at % (bytes.size() - from);
  std::memcpy(bytes.data() + to, change.data(), std::min(change.size(), bytes.size() - to));
}

core::OpenFile memory_file() {
  core::OpenFile file(::memfd_create("checkpoint", MFD_CLOEXEC));
  expect(file.valid(), "a file can be created");
  return file;
}

core::OpenFile file_of(const std::vector<std::byte>& index, const std::vector<std::byte>& block) {
  core::OpenFile file = memory_file();
  auto out = core::BlockFileWriter::to(core::OpenFile(::dup(file.get())), "", client::checkpoint_format(), 1);
  out.write_block(block);
  expect(out.finish(index).has_value(), "a file can be written");
  return file;
}

void check(core::OpenFile file, bool is_original) {
  const auto read = client::read_checkpoint(std::move(file), "checkpoint", identity());
  expect(read.has_value() || !is_original, "what was written can be read");
  if (!expect_answer(read)) return;
  expect(read->film.samples(0) <= kSpp, "no tile has more samples than the render");
  expect(read->film.develop().pixels.size() == kImage.pixel_count(), "the film is of this render");
}

void change_and_continue(std::string_view input) {
  static const Original original;
  std::vector<std::byte> index = original.index, block = original.block;
  std::string bytes = original.file;
  for (const Part& part : parts_of(input)) {
    if (part.name == "index") put(index, 0, part.bytes);
    if (part.name == "tail") put(index, index.size() - std::min(index.size(), kTailBytes), part.bytes);
    if (part.name == "block") put(block, 0, part.bytes);
    if (part.name == "cut") index.resize(std::min(index.size(), part.bytes.size()));
    if (part.name == "file") put(bytes, 0, part.bytes);
  }
  check(file_of(index, block), index == original.index && block == original.block);
  core::OpenFile file = memory_file();
  expect(core::write_at(file.get(), std::as_bytes(std::span(bytes)), 0), "a file can be written");
  const auto read = client::read_checkpoint(std::move(file), "checkpoint", identity());
  expect_answer(read);
  expect(read.has_value() == (bytes == original.file), "a file is continued if it is what was written");
}

}  // namespace

TESSERA_FUZZER(checkpoint, std::string_view input) {
  change_and_continue(input);
}

}  // namespace tessera::fuzz::checkpoint_fuzz
