// SPDX-License-Identifier: Apache-2.0
#include "core/scene/mitsuba/media.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "core/base/suggestion.hpp"
#include "core/geometry/placement.hpp"
#include "core/scene/mitsuba/grid_volume.hpp"

namespace tessera::core::mitsuba {
namespace {

// The voxels' channels, as colours.
Rgb voxel(const VoxelGrid& grid, std::size_t i) {
  if (grid.channels == 1) return Rgb::gray(grid.values[i]);
  return {grid.values[3 * i], grid.values[3 * i + 1], grid.values[3 * i + 2]};
}

// A grid of the lattice of `like`, of three channels, with value(i) in voxel i.
template <typename Value>
VoxelGrid colored_grid(const VoxelGrid& like, const Value& value) {
  VoxelGrid result = like;
  result.channels = 3;
  result.values.clear();
  for (std::size_t i = 0; i < like.voxel_count(); ++i) {
    const Rgb c = value(i);
    result.values.insert(result.values.end(), {c.r, c.g, c.b});
  }
  return result;
}

// The centre of a voxel in the unit cube.
Vec3 center_of(const VoxelGrid& grid, std::size_t i) {
  const auto along = [](std::size_t at, std::uint32_t side) {
    return (static_cast<float>(at) + 0.5f) / static_cast<float>(side);
  };
  return {along(i % grid.size[0], grid.size[0]), along(i / grid.size[0] % grid.size[1], grid.size[1]),
          along(i / grid.size[0] / grid.size[1], grid.size[2])};
}

// The values of `grid` in the voxels of another lattice. Beyond its faces they are those at the faces.
VoxelGrid resampled(const VoxelGrid& grid, const Transform& to_world, const VoxelGrid& lattice,
                    const Transform& lattice_to_world) {
  std::optional<Placement> placement;
  if (to_world != lattice_to_world && Placement::can_place(to_world)) placement.emplace(to_world);
  return colored_grid(lattice, [&](std::size_t i) {
    Vec3 p = center_of(lattice, i);
    if (placement) p = placement->object_point(Vec3d(lattice_to_world.point(p))).rounded();
    return value_at(grid,
                    {std::clamp(p.x, 0.0f, 1.0f), std::clamp(p.y, 0.0f, 1.0f), std::clamp(p.z, 0.0f, 1.0f)});
  });
}

Rgb clamped_to_unit(Rgb c) {
  return {std::clamp(c.r, 0.0f, 1.0f), std::clamp(c.g, 0.0f, 1.0f), std::clamp(c.b, 0.0f, 1.0f)};
}

}  // namespace

MediumInterface MediumConverter::interface_of(const Plugin& shape) {
  const auto side = [&](std::string_view name, const std::optional<Plugin>& light) {
    const auto found = shape.child(name);
    return found && found->kind() == Kind::kMedium ? medium(*found, light) : kNoMedium;
  };
  const auto light = volume_light_of(shape);
  const MediumInterface media{side("interior", light), side("exterior", std::nullopt)};
  if (light && media.interior == kNoMedium) light->warn("needs a medium inside of its shape; it is left out");
  return media;
}

int MediumConverter::medium_around(const Plugin& sensor) {
  const std::vector<Plugin> media = sensor.children(Kind::kMedium);
  if (media.size() > 1) sensor.warn("has several media, which Mitsuba refuses; the first one is used");
  return media.empty() ? kNoMedium : medium(media.front(), std::nullopt);
}

int MediumConverter::medium(const Plugin& plugin, const std::optional<Plugin>& light) {
  const std::pair key(plugin.id(), light ? light->id() : plugin.id());
  if (const auto known = media_.find(key); known != media_.end()) return known->second;
  auto& media = conversion_.builder.scene().media;
  int index = kNoMedium;
  if (auto made = convert(plugin)) {
    if (light) add_emission(*light, *made);
    index = static_cast<int>(media.size());
    media.push_back(std::move(*made));
  }
  media_.emplace(key, index);
  return index;
}

std::optional<MediumDescription> MediumConverter::convert(const Plugin& plugin) {
  if (plugin.type() != "homogeneous" && plugin.type() != "heterogeneous") {
    plugin.warn("is not supported; it is left out");
    plugin.ignore_all();
    return std::nullopt;
  }
  plugin.ignore({"sample_emitters", "has_spectral_extinction", "medium_sampling_mode", "sigma_n",
                 "majorant_resolution_factor", "control_density"});
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
  if (albedo.grid) return set_grids(plugin, extinction, albedo, medium);
  const Rgb scattered = clamped_to_unit(albedo.value);
  if (!extinction.grid) {
    medium.sigma_s = extinction.value * scattered;
    medium.sigma_a = extinction.value - medium.sigma_s;
    return;
  }
  medium.grid_to_world = extinction.to_world;
  medium.sigma_s = scattered;
  medium.sigma_a = Rgb::gray(1) - scattered;
  medium.absorption_grid = medium.scattering_grid = add_grid(*extinction.grid);
}

// The products of the albedo and the extinction, voxel by voxel of the finer grid. Grids in different places
// share that of the extinction, which bounds the medium.
void MediumConverter::set_grids(const Plugin& plugin, const Coefficient& extinction,
                                const Coefficient& albedo, MediumDescription& medium) {
  const bool has_two = extinction.grid.has_value();
  const bool same_place = has_two && extinction.to_world == albedo.to_world;
  const bool by_albedo =
      !has_two || (same_place && albedo.grid->voxel_count() > extinction.grid->voxel_count());
  const Coefficient& lattice = by_albedo ? albedo : extinction;
  if (!has_two) {
    plugin.warn("a constant 'sigma_t' ends where the grid of the albedo does");
  } else if (!same_place || extinction.grid->size != albedo.grid->size) {
    plugin.warn(by_albedo ? "'sigma_t' is resampled to the grid of the albedo"
                          : "the albedo is resampled to the grid of 'sigma_t'");
  }
  const auto in_lattice = [&](const Coefficient& c) {
    if (c.grid->size == lattice.grid->size && c.to_world == lattice.to_world) return *c.grid;
    return resampled(*c.grid, c.to_world, *lattice.grid, lattice.to_world);
  };
  const VoxelGrid shares = in_lattice(albedo);
  const VoxelGrid whole = has_two ? in_lattice(extinction) : VoxelGrid{};
  const auto extinction_in = [&](std::size_t i) { return has_two ? voxel(whole, i) : Rgb::gray(1); };
  medium.grid_to_world = lattice.to_world;
  medium.sigma_s = medium.sigma_a = has_two ? Rgb::gray(1) : extinction.value;
  medium.scattering_grid = add_grid(colored_grid(
      *lattice.grid, [&](std::size_t i) { return extinction_in(i) * clamped_to_unit(voxel(shares, i)); }));
  medium.absorption_grid = add_grid(colored_grid(*lattice.grid, [&](std::size_t i) {
    return extinction_in(i) * (Rgb::gray(1) - clamped_to_unit(voxel(shares, i)));
  }));
}

// Media emit sigma_a * emission per unit of length, so that those that emit must absorb.
void MediumConverter::add_emission(const Plugin& light, MediumDescription& medium) {
  light.ignore({"sampling_weight"});
  const Coefficient radiance = coefficient(light, "radiance", 0);
  if (radiance.grid || medium.has_grid()) return add_emission_grid(light, radiance, medium);
  constexpr float kMinAbsorption = 1e-3f;
  Rgb absorption = medium.sigma_a * medium.scale;
  bool is_raised = false;
  const auto emission_of = [&](float emitted, float& absorbed) {
    if (!(emitted > 0)) return 0.0f;
    is_raised |= absorbed < kMinAbsorption;
    absorbed = std::max(absorbed, kMinAbsorption);
    return emitted / absorbed;
  };
  medium.emission = {emission_of(radiance.value.r, absorption.r), emission_of(radiance.value.g, absorption.g),
                     emission_of(radiance.value.b, absorption.b)};
  if (!is_raised) return;
  light.warn(fmt::format("needs a medium that absorbs; it absorbs {:g} per unit of length", kMinAbsorption));
  medium.sigma_s *= medium.scale;
  medium.sigma_a = absorption;
  medium.scale = 1;
}

// Emission in the voxels of the light, or else of the medium, over the absorption there.
void MediumConverter::add_emission_grid(const Plugin& light, const Coefficient& radiance,
                                        MediumDescription& medium) {
  const auto& grids = conversion_.builder.scene().grids;
  const auto grid_of = [&](int index) { return grids[static_cast<std::size_t>(index)]; };
  if (!medium.has_grid()) {
    light.warn("a medium without grids ends where the grid of its radiance does");
    medium.grid_to_world = radiance.to_world;
  }
  std::optional<VoxelGrid> absorption;
  if (medium.absorption_grid >= 0) absorption = grid_of(medium.absorption_grid);
  VoxelGrid lattice = radiance.grid ? *radiance.grid : *absorption;
  if (radiance.grid && radiance.to_world != medium.grid_to_world) {
    light.warn("its radiance is resampled to the grid of the medium");
    if (absorption) lattice = *absorption;
    lattice = resampled(*radiance.grid, radiance.to_world, lattice, medium.grid_to_world);
  }
  bool is_dark = false;
  const auto quotient = [&](float emitted, float absorbed) {
    is_dark |= emitted > 0 && !(absorbed > 0);
    return absorbed > 0 ? emitted / absorbed : 0.0f;
  };
  medium.emission = Rgb::gray(1);
  medium.emission_grid = add_grid(colored_grid(lattice, [&](std::size_t i) {
    const Rgb emitted = radiance.grid ? voxel(lattice, i) : radiance.value;
    const Rgb density = absorption ? value_at(*absorption, center_of(lattice, i)) : Rgb::gray(1);
    const Rgb absorbed = medium.sigma_a * medium.scale * density;
    return Rgb{quotient(emitted.r, absorbed.r), quotient(emitted.g, absorbed.g),
               quotient(emitted.b, absorbed.b)};
  }));
  if (is_dark) light.warn("does not emit where the medium does not absorb");
}

MediumConverter::Coefficient MediumConverter::coefficient(const Plugin& owner, std::string_view name,
                                                          float otherwise) {
  const Property* property = owner.property(name);
  const auto not_negative = [](Rgb c) {
    return Rgb{std::max(c.r, 0.0f), std::max(c.g, 0.0f), std::max(c.b, 0.0f)};
  };
  if (property == nullptr) return {Rgb::gray(otherwise), {}, {}};
  if (const auto constant = constant_color(*property)) return {not_negative(*constant), {}, {}};
  if (const auto volume = owner.child(name)) {
    if (volume->type() == "constvolume") return coefficient(*volume, "value", otherwise);
    if (volume->type() == "gridvolume")
      if (auto placed = read_grid_volume(conversion_, *volume)) {
        if (placed->wrap != Wrap::kClamp) volume->warn("the wrap_mode is 'clamp'");
        return {Rgb::gray(1), std::move(placed->grid), placed->to_world};
      }
  }
  owner.warn(
      fmt::format("'{}' is no colour, <volume type=\"constvolume\"> or <volume type=\"gridvolume\">; {} "
                  "replaces it",
                  name, otherwise));
  return {Rgb::gray(otherwise), {}, {}};
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
