// SPDX-License-Identifier: Apache-2.0
#include "client/render_checkpoint.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <functional>
#include <numeric>
#include <span>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "core/scene/cache/archive.hpp"

namespace tessera::core {

auto fields(stored::Is<Checksum> auto& value) {
  auto& [low, high] = value;
  return std::tie(low, high);
}
auto fields(stored::Is<SceneDigest> auto& value) {
  auto& [camera, textures, materials, shapes, lights, environment] = value;
  return std::tie(camera, textures, materials, shapes, lights, environment);
}
auto fields(stored::Is<SampleId> auto& value) {
  auto& [x, y, sample] = value;
  return std::tie(x, y, sample);
}
auto fields(stored::Is<RenderCounters> auto& value) {
  auto& [samples, closest_hits, shadow_rays, non_finite, saturated, first_non_finite] = value;
  return std::tie(samples, closest_hits, shadow_rays, non_finite, saturated, first_non_finite);
}

}  // namespace tessera::core

namespace tessera::client {

using core::ErrorCode;
using core::fail;
using core::Result;
using core::Status;
using TileSums = core::Film::TileSums;

auto fields(core::stored::Is<RenderIdentity> auto& value) {
  auto& [version, determinism_fingerprint, settings, scene] = value;
  return std::tie(version, determinism_fingerprint, settings, scene);
}
auto fields(core::stored::Is<RenderTotals> auto& value) {
  auto& [counters, seconds, core_seconds] = value;
  return std::tie(counters, seconds, core_seconds);
}
auto fields(core::stored::Is<CheckpointHeader> auto& value) {
  auto& [render, totals] = value;
  return std::tie(render, totals);
}
namespace {

static_assert(std::endian::native == std::endian::little);

// The words of a plane in as few bytes each as the largest needs.
struct StoredPlane {
  std::uint8_t word_bytes = 0;
  std::vector<std::uint8_t> words;
};

auto fields(core::stored::Is<StoredPlane> auto& value) {
  auto& [word_bytes, words] = value;
  return std::tie(word_bytes, words);
}

// The sums of a grid tile in as few bytes each as the largest needs.
struct StoredTile {
  std::uint32_t samples = 0;
  std::uint8_t sum_bytes = 0, odd_sum_bytes = 0;
  std::vector<std::uint8_t> sums;  // then the odd ones
  std::vector<StoredPlane> planes;
};

auto fields(core::stored::Is<StoredTile> auto& value) {
  auto& [samples, sum_bytes, odd_sum_bytes, sums, planes] = value;
  return std::tie(samples, sum_bytes, odd_sum_bytes, sums, planes);
}

std::uint8_t bytes_needed(const std::vector<std::uint64_t>& sums) {
  const auto bits = std::accumulate(sums.begin(), sums.end(), std::uint64_t{0}, std::bit_or<>());
  return static_cast<std::uint8_t>((std::bit_width(bits) + 7) / 8);
}

void pack(const std::vector<std::uint64_t>& sums, std::size_t bytes, std::vector<std::uint8_t>& to) {
  if (bytes == 0) return;
  std::size_t at = to.size();
  to.resize(at + sums.size() * bytes);
  for (const std::uint64_t& sum : sums) {
    std::memcpy(to.data() + at, &sum, bytes);
    at += bytes;
  }
}

std::vector<std::uint64_t> unpack(std::span<const std::uint8_t> from, std::size_t bytes, std::size_t count) {
  std::vector<std::uint64_t> sums(count);
  if (bytes == 0) return sums;
  for (std::size_t i = 0; i < count; ++i) std::memcpy(&sums[i], from.data() + i * bytes, bytes);
  return sums;
}

StoredTile stored(const TileSums& tile) {
  StoredTile result{tile.samples, bytes_needed(tile.sums), bytes_needed(tile.odd_sums), {}, {}};
  pack(tile.sums, result.sum_bytes, result.sums);
  pack(tile.odd_sums, result.odd_sum_bytes, result.sums);
  for (const core::Plane& plane : tile.planes) {
    StoredPlane& packed = result.planes.emplace_back();
    packed.word_bytes = bytes_needed(plane);
    pack(plane, packed.word_bytes, packed.words);
  }
  return result;
}

// nullopt if no film of this rectangle has them.
std::optional<core::Planes> restored(const std::vector<StoredPlane>& planes, const core::FilmLayout& layout,
                                     const core::PixelRect& rect, std::uint32_t samples) {
  core::Planes result;
  for (const StoredPlane& plane : planes) {
    const std::size_t bytes = plane.word_bytes;
    if (bytes > 8 || (bytes == 0 ? !plane.words.empty() : plane.words.size() % bytes != 0))
      return std::nullopt;
    const std::size_t words = bytes == 0 ? 0 : plane.words.size() / bytes;
    if (words > 2 * core::kMaxIdsPerPixel * rect.pixel_count()) return std::nullopt;
    result.push_back(unpack(plane.words, bytes, words));
  }
  if (result.size() != (samples == 0 ? 0 : layout.planes())) return std::nullopt;
  if (!core::check_planes(layout, result, rect, samples)) return std::nullopt;
  return result;
}

// The sums of a tile; nullopt if no film has them. Samples are those from 0 on.
std::optional<TileSums> restored(const StoredTile& tile, const core::FilmLayout& layout,
                                 const core::PixelRect& rect) {
  const std::size_t channels = layout.sums(rect.pixel_count());
  const std::size_t sum_bytes = tile.sum_bytes, odd_bytes = tile.odd_sum_bytes;
  if (tile.samples > core::kMaxSpp || sum_bytes > 8 || odd_bytes > 8) return std::nullopt;
  if (tile.sums.size() != (tile.samples == 0 ? std::size_t{0} : channels * (sum_bytes + odd_bytes)))
    return std::nullopt;
  auto planes = restored(tile.planes, layout, rect, tile.samples);
  if (!planes) return std::nullopt;
  if (tile.samples == 0) return TileSums{};
  const std::span<const std::uint8_t> all(tile.sums);
  return TileSums{unpack(all, sum_bytes, channels),
                  unpack(all.subspan(channels * sum_bytes), odd_bytes, channels), tile.samples,
                  tile.samples / 2, *std::move(planes)};
}

tl::unexpected<core::Error> cannot_write(const std::string& path, int error) {
  return fail(error == ENOSPC || error == EDQUOT ? ErrorCode::kResourceExhausted : ErrorCode::kUnavailable,
              fmt::format("cannot write '{}': {}", path, std::strerror(error)));
}

Status write_to(core::OpenFile file, const std::string& name, const RenderIdentity& render,
                SharedFilm& film) {
  core::BlockFileWriter blocks = core::BlockFileWriter::to(std::move(file), name, checkpoint_format(), 1);
  core::stored::Writer writer(blocks);
  SharedFilm::Snapshot snapshot(film);
  writer(CheckpointHeader{render, snapshot.totals()});
  for (int tile = 0; tile < film.grid().tile_count(); ++tile) writer(stored(snapshot.take(tile)));
  return blocks.finish(writer.bytes());
}

// Makes the new name of a file in this folder durable, where the system can.
void flush_folder(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  const core::OpenFile open(
      ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (open.valid()) ::fsync(open.get());
}

tl::unexpected<core::Error> damaged(const std::string& name) {
  return fail(ErrorCode::kDataLoss, fmt::format("'{}' is damaged: render without --resume", name));
}

// What is wrong with the file, for users of --resume.
tl::unexpected<core::Error> unreadable(const std::string& name, const core::Error& error) {
  if (error.code == ErrorCode::kNotFound)
    return fail(error.code, fmt::format("there is no checkpoint '{}'", name));
  return fail(error.code,
              fmt::format("{}: it is no checkpoint that this release can continue", error.message));
}

Status check_samples(const RenderTotals& totals, const core::Film& film) {
  std::uint64_t samples = 0;
  for (int tile = 0; tile < film.grid().tile_count(); ++tile)
    samples += std::uint64_t{film.grid().rect(tile).pixel_count()} * film.samples(tile);
  if (samples == totals.counters.samples) return {};
  return fail(ErrorCode::kDataLoss, "the samples do not add up");
}

}  // namespace

core::Checksum checkpoint_format() {
  constexpr std::string_view kFormat = "checkpoint of a render 2";
  return core::checksum_of(std::as_bytes(std::span(kFormat)));
}

Status write_checkpoint(const std::string& path, const RenderIdentity& render, SharedFilm& film) {
  const std::string partial = path + ".partial";
  ::unlink(partial.c_str());  // of a run that was killed
  const core::OpenFile file(::open(partial.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (!file.valid()) return cannot_write(path, errno);
  Status written = write_to(core::OpenFile(::fcntl(file.get(), F_DUPFD_CLOEXEC, 0)), path, render, film);
  if (written && (::fsync(file.get()) != 0 || std::rename(partial.c_str(), path.c_str()) != 0))
    written = cannot_write(path, errno);
  if (!written) ::unlink(partial.c_str());
  if (written) flush_folder(path);
  return written;
}

Result<CheckpointHeader> read_checkpoint_header(const std::string& path) {
  auto file = core::BlockFileReader::open(path, checkpoint_format(), 1);
  if (!file) return unreadable(path, file.error());
  CheckpointHeader header;
  core::stored::Reader reader(*file);
  reader(header);
  if (!reader.good()) return damaged(path);
  return header;
}

Result<Checkpoint> read_checkpoint(core::OpenFile file, const std::string& name,
                                   const RenderIdentity& render) {
  auto blocks = core::BlockFileReader::of(std::move(file), name, checkpoint_format(), 1);
  if (!blocks) return unreadable(name, blocks.error());
  CheckpointHeader header;
  core::stored::Reader reader(*blocks);
  reader(header);
  if (!reader.good()) return damaged(name);
  if (const std::string what = difference(header.render, render); !what.empty())
    return fail(ErrorCode::kFailedPrecondition,
                fmt::format("'{}' belongs to another render: {}", name, what));
  const core::LayerSet layers = render.settings.layers;
  Checkpoint checkpoint{header, core::Film(core::TileGrid(render.settings.window(), core::kTilePx), layers)};
  const core::FilmLayout layout = core::film_layout(layers);
  const core::TileGrid& grid = checkpoint.film.grid();
  std::uint32_t most = 0;
  for (int tile = 0; tile < grid.tile_count(); ++tile) {
    StoredTile stored;
    reader(stored);
    const auto sums = restored(stored, layout, grid.rect(tile));
    if (!reader.good() || !sums) return damaged(name);
    checkpoint.film.restore(tile, *sums);
    most = std::max(most, sums->samples);
  }
  if (!reader.complete() || !check_samples(header.totals, checkpoint.film)) return damaged(name);
  if (most > render.settings.spp)
    return fail(ErrorCode::kFailedPrecondition,
                fmt::format("'{}' has {} samples per pixel already: give a larger --spp than {}", name, most,
                            render.settings.spp));
  return checkpoint;
}

Result<Checkpoint> read_checkpoint(const std::string& path, const RenderIdentity& render) {
  core::OpenFile file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (file.valid()) return read_checkpoint(std::move(file), path, render);
  if (errno == ENOENT) return fail(ErrorCode::kNotFound, fmt::format("there is no checkpoint '{}'", path));
  return fail(ErrorCode::kUnavailable, fmt::format("cannot read '{}': {}", path, std::strerror(errno)));
}

}  // namespace tessera::client
