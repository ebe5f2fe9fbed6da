// SPDX-License-Identifier: Apache-2.0
// Media of NanoVDB files.
#include <fmt/format.h>

#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "core/scene/loader/nanovdb_file.hpp"
#include "core/scene/loader/nanovdb_grid.hpp"
#include "core/scene/loader/wording.hpp"
#include "core/scene/pbrt/files.hpp"
#include "core/scene/pbrt/media.hpp"

namespace tessera::core::pbrt {
namespace {

constexpr std::uint64_t kMaxVoxels = 1u << 24;

// A grid of a file, as it is there.
struct FileGrid {
  std::string content{};  // of the bytes, if they were compressed
  std::string_view bytes{};
  GridShape shape{};
};

Result<std::unique_ptr<FileGrid>> open_grid(std::string_view file, std::string_view name) {
  auto grid = std::make_unique<FileGrid>();
  const auto bytes = find_nanovdb_grid(file, name, grid->content);
  if (!bytes) return fail(bytes.error());
  if (!*bytes) return fail(ErrorCode::kNotFound, fmt::format("has no grid {}", in_quotes(name)));
  grid->bytes = **bytes;
  auto shape = shape_of(grid->bytes, kMaxVoxels);
  if (!shape) return fail(shape.error());
  grid->shape = *shape;
  return grid;
}

}  // namespace

bool Media::read_nanovdb(const Parameters& p, const Matrix& to_world, MediumDescription& medium) {
  read_common(p, medium);
  const std::string name = p.file_name("filename");
  const Place place = p.place_of(p.find("filename"));
  const auto warn = [&](std::string_view what) {
    report_.warn(place, "grids " + name, fmt::format("the file {} {}", in_quotes(name), what));
  };
  const auto path = find_file(builder_, place, name);
  const auto file = path ? builder_.read(*path) : Result<std::string>(fail(ErrorCode::kNotFound, ""));
  if (!file) return warn(path ? "cannot be read" : "does not exist"), false;
  const auto density = open_grid(*file, "density");
  if (!density) return warn(density.error().message), false;
  const GridShape& shape = (*density)->shape;
  // A large file with few voxels takes time, too.
  constexpr std::uint64_t kBytesOfAValue = 16;
  if (!reserve_values(shape.voxel_count() + (*density)->bytes.size() / kBytesOfAValue, place)) return false;
  if (shape.reduction > 1)
    warn(fmt::format("has more than {} voxels; {} along each axis become their mean", kMaxVoxels,
                     shape.reduction));
  auto voxels = voxels_of((*density)->bytes, shape);
  if (!voxels) return warn(voxels.error().message), false;
  add_temperatures(p, *file, shape, medium);
  medium.grid_to_world = (to_world * Matrix{shape.to_world}).transform();
  medium.absorption_grid = medium.scattering_grid = add_grid(*std::move(voxels));
  return true;
}

void Media::add_temperatures(const Parameters& p, std::string_view file, const GridShape& shape,
                             MediumDescription& medium) {
  const Place place = p.place_of(p.find("filename"));
  const auto grid = open_grid(file, "temperature");
  if (!grid && grid.error().code == ErrorCode::kNotFound) return;
  if (grid && !reserve_values(3 * shape.voxel_count(), place)) return;
  const auto temperatures = grid ? voxels_of((*grid)->bytes, shape) : fail(grid.error());
  if (temperatures) return set_temperatures(p, *temperatures, std::nullopt, medium);
  report_.warn(place, fmt::format("the grid 'temperature' of the medium's file {}; it does not glow",
                                  temperatures.error().message));
}

}  // namespace tessera::core::pbrt
