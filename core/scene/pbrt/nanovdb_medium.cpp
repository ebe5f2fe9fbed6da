// SPDX-License-Identifier: Apache-2.0
// Media of NanoVDB files.
#include <fmt/format.h>

#include <string>
#include <utility>

#include "core/scene/loader/nanovdb_file.hpp"
#include "core/scene/loader/nanovdb_grid.hpp"
#include "core/scene/loader/wording.hpp"
#include "core/scene/pbrt/files.hpp"
#include "core/scene/pbrt/media.hpp"

namespace tessera::core::pbrt {
namespace {

constexpr std::uint64_t kMaxVoxels = 1u << 24;

// A grid of a file, with the voxels of `other` if there is one; nullopt if the file has none of this name.
Result<std::optional<DenseGrid>> grid_in(std::string_view file, std::string_view name,
                                         const DenseGrid* other = nullptr) {
  std::string content;
  const auto bytes = find_nanovdb_grid(file, name, content);
  if (!bytes) return fail(bytes.error());
  if (!*bytes) return std::optional<DenseGrid>();
  auto dense = other != nullptr ? dense_grid(**bytes, *other) : dense_grid(**bytes, kMaxVoxels);
  if (!dense) return fail(dense.error());
  return std::optional(*std::move(dense));
}

}  // namespace

bool Media::read_nanovdb(const Parameters& p, const Matrix& to_world, MediumDescription& medium) {
  read_common(p, medium);
  const std::string name = p.text("filename");
  const Place place = p.place_of(p.find("filename"));
  const auto warn = [&](std::string_view what) {
    report_.warn(place, "grids " + name, fmt::format("the file {} {}", in_quotes(name), what));
  };
  const auto path = find_file(builder_, place, name);
  const auto file = path ? builder_.read(*path) : Result<std::string>(fail(ErrorCode::kNotFound, ""));
  if (!file) return warn(path ? "cannot be read" : "does not exist"), false;
  auto density = grid_in(*file, "density");
  if (!density || !*density) return warn(density ? "has no grid 'density'" : density.error().message), false;
  const DenseGrid& dense = **density;
  if (!may_compute(dense.voxels.values.size(), place)) return false;
  if (dense.reduction > 1)
    warn(fmt::format("has more than {} voxels; {} along each side become their mean", kMaxVoxels,
                     dense.reduction));
  const auto temperatures = grid_in(*file, "temperature", &dense);
  if (!temperatures) warn(temperatures.error().message + "; it does not glow");
  if (temperatures && *temperatures && may_compute(3 * dense.voxels.values.size(), place))
    set_temperatures(p, (*temperatures)->voxels, std::nullopt, medium);
  medium.grid_to_world = (to_world * Matrix{dense.to_world}).transform();
  medium.absorption_grid = medium.scattering_grid = add_grid(std::move((*density)->voxels));
  return true;
}

}  // namespace tessera::core::pbrt
