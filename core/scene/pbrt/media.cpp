// SPDX-License-Identifier: Apache-2.0
#include "core/scene/pbrt/media.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/scene/loader/wording.hpp"
#include "core/scene/pbrt/cloud_density.hpp"
#include "core/scene/pbrt/measured_media.hpp"
#include "core/scene/pbrt/temperature.hpp"

namespace tessera::core::pbrt {
namespace {

constexpr float kMaxCoefficient = 1e15f, kMaxAsymmetry = 0.999f;

float coefficient(float value) {
  return std::isfinite(value) ? std::clamp(value, 0.0f, kMaxCoefficient) : 0.0f;
}

Rgb coefficients(Rgb c) {
  return {coefficient(c.r), coefficient(c.g), coefficient(c.b)};
}

}  // namespace

bool Media::define(const std::string& name, const Parameters& p, const Matrix& to_world) {
  if (!p.has("type")) report_.warn(p.place(), "a medium without a \"type\" is homogeneous");
  const std::string type = p.text("type", "homogeneous");
  MediumDescription medium;
  medium.name = name;
  bool is_supported = true;
  if (type == "homogeneous") {
    read_common(p, medium);
  } else if (type == "uniformgrid") {
    is_supported = read_uniform_grid(p, to_world, medium);
  } else if (type == "rgbgrid") {
    is_supported = read_rgb_grid(p, to_world, medium);
  } else if (type == "cloud") {
    is_supported = read_cloud(p, to_world, medium);
  } else if (type == "nanovdb") {
    is_supported = read_nanovdb(p, to_world, medium);
  } else {
    for (const Parameter& parameter : p.list()) p.find(parameter.name);
    is_supported = false;
  }
  if (!is_supported) {
    report_.warn(
        p.place(), "medium " + type,
        fmt::format("the medium {} of the type {} is not supported, or has no values; it is left out",
                    in_quotes(name), in_quotes(type)));
    return names_.insert_or_assign(name, kNoMedium).second;
  }
  report_.tell(p, fmt::format("the medium '{}'", type));
  auto& media = builder_.scene().media;
  media.push_back(std::move(medium));
  return names_.insert_or_assign(name, static_cast<int>(media.size()) - 1).second;
}

int Media::find(const std::string& name, const Place& place) const {
  if (name.empty()) return kNoMedium;
  const auto known = names_.find(name);
  if (known != names_.end()) return known->second;
  report_.warn(place, "unknown medium " + name,
               fmt::format("there is no medium {}; vacuum is used", in_quotes(name)));
  return kNoMedium;
}

// Coefficients are per unit of length; measured ones are those for millimetres. The defaults are those of
// pbrt-v4 itself, whose documentation names others.
void Media::read_common(const Parameters& p, MediumDescription& medium) {
  const std::string preset = p.text("preset");
  const MeasuredMedium* measured = find_measured_medium(preset);
  if (!preset.empty() && measured == nullptr)
    report_.warn(
        p.place(), "medium preset " + preset,
        fmt::format("the medium {} is not known; its sigma_a and sigma_s are used", in_quotes(preset)));
  const Rgb one = Rgb::gray(1);
  medium.sigma_a = coefficients(colors_.color(p, "sigma_a", SpectrumRole::kUnbounded, one));
  medium.sigma_s = coefficients(colors_.color(p, "sigma_s", SpectrumRole::kUnbounded, one));
  if (measured != nullptr) {
    medium.sigma_a = measured->sigma_a, medium.sigma_s = measured->sigma_s;
    for (const char* name : {"sigma_a", "sigma_s"})
      if (p.has(name)) p.remark(name, "is ignored, because there is a \"preset\"");
  }
  read_scale(p, medium);
  if (!p.has("Le")) return;
  const Rgb emitted = colors_.color(p, "Le", SpectrumRole::kIlluminant, {});
  medium.emission = coefficients(exposure_(emitted) * emission_scale(p));
}

void Media::read_scale(const Parameters& p, MediumDescription& medium) const {
  medium.scale = p.number_in("scale", 1, 0, kMaxCoefficient);
  medium.g = p.number_in("g", 0, -kMaxAsymmetry, kMaxAsymmetry);
}

// Several values are a grid.
float Media::emission_scale(const Parameters& p) const {
  const char* name = p.has("LeScale") ? "LeScale" : "Lescale";
  const Parameter* given = p.find(name);
  return given != nullptr && given->size() > 1 ? 1 : p.number_in(name, 1, 0, kMaxCoefficient);
}

std::optional<VoxelGrid> Media::grid_of(const Parameters& p, std::string_view name, std::uint32_t channels) {
  const Parameter* given = p.find(name);
  if (given == nullptr) return std::nullopt;
  VoxelGrid grid;
  const auto side = [&](std::string_view key) {
    return static_cast<std::uint32_t>(p.integer_in(key, 1, 1, static_cast<int>(kMaxGridSide)));
  };
  grid.size = {side("nx"), side("ny"), side("nz")};
  grid.channels = channels;
  grid.border = GridBorder::kZero;
  grid.values = given->floats;
  if (grid.values.size() != grid.voxel_count() * channels) {
    report_.warn(
        p.place_of(given),
        fmt::format("the grid {} does not have one value for each voxel; it is ignored", in_quotes(name)));
    return std::nullopt;
  }
  const auto is_usable = [](float value) { return value == coefficient(value); };
  if (!std::all_of(grid.values.begin(), grid.values.end(), is_usable))
    p.remark(name, "has values that are negative, infinite or no numbers; they are clamped");
  for (float& value : grid.values) value = coefficient(value);
  return grid;
}

bool Media::reserve_values(std::uint64_t count, const Place& place) {
  constexpr std::uint64_t kMaxValues = 1u << 27;
  if (reserved_values_ + count > kMaxValues) {
    report_.warn(place,
                 fmt::format("clouds and NanoVDB files have more than {} values together; further ones "
                             "are left out",
                             kMaxValues));
    return false;
  }
  reserved_values_ += count;
  return true;
}

int Media::add_grid(std::optional<VoxelGrid> grid) {
  if (!grid) return -1;
  auto& grids = builder_.scene().grids;
  grids.push_back(*std::move(grid));
  return static_cast<int>(grids.size()) - 1;
}

// The grid fills the box between p0 and p1.
void Media::place_grid(const Parameters& p, const Matrix& to_world, MediumDescription& medium) const {
  const Vec3 from = p.vector("p0", {}), size = p.vector("p1", {1, 1, 1}) - from;
  const auto wide = [](float c) { return static_cast<double>(c); };
  medium.grid_to_world = (to_world * translate(wide(from.x), wide(from.y), wide(from.z)) *
                          scale(wide(size.x), wide(size.y), wide(size.z)))
                             .transform();
}

bool Media::read_uniform_grid(const Parameters& p, const Matrix& to_world, MediumDescription& medium) {
  read_common(p, medium);
  const int density = add_grid(grid_of(p, "density", 1));
  medium.absorption_grid = medium.scattering_grid = density;
  // A single "Lescale" is a factor, several are a grid.
  const Parameter* given = p.find("Lescale");
  auto shares = given != nullptr && given->floats.size() > 1 ? grid_of(p, "Lescale", 1) : std::nullopt;
  if (const auto temperatures = grid_of(p, "temperature", 1)) {
    set_temperatures(p, *temperatures, shares, medium);
  } else if (shares) {
    medium.emission = coefficients(exposure_(colors_.color(p, "Le", SpectrumRole::kIlluminant, {})));
    medium.emission_grid = add_grid(std::move(shares));
  } else if (p.has("Le")) {
    medium.emission_grid = add_grid(VoxelGrid{.size = {1, 1, 1}, .values = {1}, .border = GridBorder::kZero});
  }
  place_grid(p, to_world, medium);
  return density >= 0;
}

void Media::set_temperatures(const Parameters& p, const VoxelGrid& temperatures,
                             const std::optional<VoxelGrid>& shares, MediumDescription& medium) {
  TemperatureUnits units;
  units.offset = p.number("temperatureoffset", p.number("temperaturecutoff", units.offset));
  units.scale = p.number("temperaturescale", units.scale);
  report_.warn(p.place(), "the light of temperatures is computed at the voxels, and linear between them");
  VoxelGrid colors = black_bodies(temperatures, units);
  for (std::size_t i = 0; shares && i < colors.values.size(); ++i) colors.values[i] *= shares->values[i / 3];
  medium.emission = coefficients(exposure_(Rgb::gray(emission_scale(p))));
  medium.emission_grid = add_grid(std::move(colors));
}

bool Media::read_rgb_grid(const Parameters& p, const Matrix& to_world, MediumDescription& medium) {
  medium.sigma_a = medium.sigma_s = Rgb::gray(1);
  read_scale(p, medium);
  medium.absorption_grid = add_grid(grid_of(p, "sigma_a", 3));
  medium.scattering_grid = add_grid(grid_of(p, "sigma_s", 3));
  medium.emission_grid = add_grid(grid_of(p, "Le", 3));
  if (medium.emission_grid >= 0) medium.emission = coefficients(exposure_(Rgb::gray(1)) * emission_scale(p));
  place_grid(p, to_world, medium);
  return medium.absorption_grid >= 0 || medium.scattering_grid >= 0;
}

bool Media::read_cloud(const Parameters& p, const Matrix& to_world, MediumDescription& medium) {
  read_common(p, medium);
  CloudDensity cloud;
  cloud.density = p.number_in("density", cloud.density, 0, kMaxCoefficient);
  cloud.wispiness = p.number_in("wispiness", cloud.wispiness, 0, kMaxCoefficient);
  cloud.frequency = p.number_in("frequency", cloud.frequency, -kMaxCoefficient, kMaxCoefficient);
  const Vec3 from = p.vector("p0", {}), to = p.vector("p1", {1, 1, 1});
  const auto size = CloudDensity::grid_size(from, to);
  if (!size || !reserve_values(std::uint64_t{(*size)[0]} * (*size)[1] * (*size)[2], p.place())) return false;
  report_.warn(p.place(), "cloud",
               fmt::format("the density of the medium 'cloud' is computed for a grid of {} x {} x {} voxels",
                           (*size)[0], (*size)[1], (*size)[2]));
  medium.absorption_grid = medium.scattering_grid = add_grid(cloud.grid(from, to, *size));
  place_grid(p, to_world, medium);
  return true;
}

}  // namespace tessera::core::pbrt
