// SPDX-License-Identifier: Apache-2.0
#include "core/scene/mitsuba/media.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "core/base/suggestion.hpp"
#include "core/scene/loader/volume_reader.hpp"

namespace tessera::core::mitsuba {
namespace {

// The box in a file of a grid, as a map from the unit cube.
Transform box_of(std::string_view bytes) {
  constexpr std::size_t kOffset = 24;
  std::array<float, 6> box{};
  if (bytes.size() < kOffset + sizeof(box)) return {};
  std::memcpy(box.data(), bytes.data() + kOffset, sizeof(box));
  const Vec3 lower{box[0], box[1], box[2]}, upper{box[3], box[4], box[5]};
  return compose(translation(lower), scaling(upper - lower));
}

// The voxels' channels, as colours.
Rgb voxel(const VoxelGrid& grid, std::size_t i) {
  if (grid.channels == 1) return Rgb::gray(grid.values[i]);
  return {grid.values[3 * i], grid.values[3 * i + 1], grid.values[3 * i + 2]};
}

Rgb mean_of(const VoxelGrid& grid) {
  std::array<double, 3> sum{};
  for (std::size_t i = 0; i < grid.voxel_count(); ++i)
    for (int c = 0; c < 3; ++c) sum[static_cast<std::size_t>(c)] += static_cast<double>(voxel(grid, i)[c]);
  const auto count = static_cast<double>(std::max<std::size_t>(grid.voxel_count(), 1));
  return {static_cast<float>(sum[0] / count), static_cast<float>(sum[1] / count),
          static_cast<float>(sum[2] / count)};
}

// The voxel by voxel result of combine(extinction, albedo), in three channels.
template <typename Combine>
VoxelGrid combined(const VoxelGrid& extinction, const VoxelGrid& albedo, const Combine& combine) {
  VoxelGrid result = extinction;
  result.channels = 3;
  result.values.clear();
  for (std::size_t i = 0; i < extinction.voxel_count(); ++i) {
    const Rgb value = combine(voxel(extinction, i), voxel(albedo, i));
    result.values.insert(result.values.end(), {value.r, value.g, value.b});
  }
  return result;
}

Rgb clamped_to_unit(Rgb c) {
  return {std::clamp(c.r, 0.0f, 1.0f), std::clamp(c.g, 0.0f, 1.0f), std::clamp(c.b, 0.0f, 1.0f)};
}

}  // namespace

MediumInterface MediumConverter::interface_of(const Plugin& shape) {
  const auto side = [&](std::string_view name) {
    const auto found = shape.child(name);
    return found && found->kind() == Kind::kMedium ? medium(*found) : kNoMedium;
  };
  return {side("interior"), side("exterior")};
}

int MediumConverter::medium(const Plugin& plugin) {
  if (const auto known = media_.find(plugin.id()); known != media_.end()) return known->second;
  auto& media = conversion_.builder.scene().media;
  int index = kNoMedium;
  if (auto made = convert(plugin)) {
    index = static_cast<int>(media.size());
    media.push_back(std::move(*made));
  }
  media_.emplace(plugin.id(), index);
  return index;
}

std::optional<MediumDescription> MediumConverter::convert(const Plugin& plugin) {
  if (plugin.type() != "homogeneous" && plugin.type() != "heterogeneous") {
    plugin.warn("is not supported; it is left out");
    plugin.ignore_all();
    return std::nullopt;
  }
  plugin.ignore(
      {"sample_emitters", "has_spectral_extinction", "majorant_resolution_factor", "control_density"});
  MediumDescription medium;
  medium.name = plugin.name();
  medium.scale = plugin.real_in("scale", 1, 0, kMaxMediumCoefficient);
  medium.g = mean_cosine(plugin);
  const Coefficient extinction = coefficient(plugin, "sigma_t", 1);
  set_coefficients(plugin, extinction, coefficient(plugin, "albedo", 0.75f), medium);
  return medium;
}

void MediumConverter::set_coefficients(const Plugin& plugin, const Coefficient& extinction,
                                       const Coefficient& albedo, MediumDescription& medium) {
  Coefficient scattered = albedo;
  scattered.value = clamped_to_unit(albedo.value);
  if (albedo.grid && (!extinction.grid || albedo.grid->size != extinction.grid->size)) {
    plugin.warn("the mean of the albedo replaces its grid, because 'sigma_t' has no grid of the same size");
    scattered = {clamped_to_unit(mean_of(*albedo.grid)), {}, {}};
  }
  if (!extinction.grid) {
    medium.sigma_s = extinction.value * scattered.value;
    medium.sigma_a = extinction.value - medium.sigma_s;
    return;
  }
  medium.grid_to_world = extinction.to_world;
  if (!scattered.grid) {
    medium.sigma_s = scattered.value;
    medium.sigma_a = Rgb::gray(1) - scattered.value;
    medium.absorption_grid = medium.scattering_grid = add_grid(*extinction.grid);
    return;
  }
  medium.sigma_s = medium.sigma_a = Rgb::gray(1);
  const auto scatter = [](Rgb sigma, Rgb a) { return sigma * clamped_to_unit(a); };
  const auto absorb = [](Rgb sigma, Rgb a) { return sigma * (Rgb::gray(1) - clamped_to_unit(a)); };
  medium.scattering_grid = add_grid(combined(*extinction.grid, *scattered.grid, scatter));
  medium.absorption_grid = add_grid(combined(*extinction.grid, *scattered.grid, absorb));
}

MediumConverter::Coefficient MediumConverter::coefficient(const Plugin& owner, std::string_view name,
                                                          float otherwise) {
  const Property* property = owner.property(name);
  const auto not_negative = [](Rgb c) {
    return Rgb{std::max(c.r, 0.0f), std::max(c.g, 0.0f), std::max(c.b, 0.0f)};
  };
  if (property == nullptr) return {Rgb::gray(otherwise), {}, {}};
  if (const auto* rgb = std::get_if<Rgb>(&property->value)) return {not_negative(*rgb), {}, {}};
  if (const auto* samples = std::get_if<Samples>(&property->value)) return {rgb_of(*samples), {}, {}};
  if (const auto* number = std::get_if<double>(&property->value))
    return {not_negative(Rgb::gray(static_cast<float>(*number))), {}, {}};
  if (const auto volume = owner.child(name)) {
    if (volume->type() == "constvolume") return coefficient(*volume, "value", otherwise);
    if (volume->type() == "gridvolume")
      if (auto grid = grid_volume(*volume)) return std::move(*grid);
  }
  owner.warn(
      fmt::format("'{}' is no colour, <volume type=\"constvolume\"> or <volume type=\"gridvolume\">; {} "
                  "replaces it",
                  name, otherwise));
  return {Rgb::gray(otherwise), {}, {}};
}

std::optional<MediumConverter::Coefficient> MediumConverter::grid_volume(const Plugin& volume) {
  volume.ignore({"raw", "accel"});
  const std::string written = volume.text("filename").value_or("");
  const auto path = conversion_.find_file(written);
  const auto bytes =
      path ? conversion_.builder.read(*path)
           : Result<std::string>(fail(ErrorCode::kNotFound, in_quotes(written) + " does not exist"));
  if (!bytes) {
    volume.warn(bytes.error().message);
    return std::nullopt;
  }
  auto grid = conversion_.builder.files().grid(*path);
  if (!grid) {
    if (grid.error().code == ErrorCode::kResourceExhausted) conversion_.check(fail(grid.error()));
    volume.warn(grid.error().message);
    return std::nullopt;
  }
  if (volume.text("filter_type").value_or("trilinear") == "nearest") grid->filter = GridFilter::kNearest;
  if (volume.text("wrap_mode").value_or("clamp") != "clamp") volume.warn("the wrap_mode is 'clamp'");
  Transform to_world = volume.transform("to_world");
  if (volume.flag("use_grid_bbox", false)) to_world = compose(to_world, box_of(*bytes));
  return Coefficient{Rgb::gray(1), std::move(*grid), to_world};
}

int MediumConverter::add_grid(VoxelGrid grid) {
  auto& grids = conversion_.builder.scene().grids;
  grids.push_back(std::move(grid));
  return static_cast<int>(grids.size()) - 1;
}

float MediumConverter::mean_cosine(const Plugin& plugin) {
  const auto phase = plugin.first_child(Kind::kPhase);
  if (!phase || phase->type() == "isotropic") return 0;
  constexpr float kMaxG = 0.999f;
  if (phase->type() == "hg") return phase->real_in("g", 0.8f, -kMaxG, kMaxG);
  phase->warn("is not supported; isotropic scattering replaces it");
  phase->ignore_all();
  return 0;
}

}  // namespace tessera::core::mitsuba
