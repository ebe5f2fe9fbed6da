// SPDX-License-Identifier: Apache-2.0
#include "core/scene/settings.hpp"

#include <fmt/format.h>
#include <array>
#include <cmath>
#include <utility>

namespace tessera::core {
namespace {

constexpr std::array<std::pair<Integrator, std::string_view>, 4> kIntegratorNames{{
    {Integrator::kNaive, "naive"},
    {Integrator::kNee, "nee"},
    {Integrator::kMis, "mis"},
    {Integrator::kWhitted, "whitted"},
}};

constexpr std::array<std::pair<FilterKind, std::string_view>, 3> kFilterNames{{
    {FilterKind::kBox, "box"},
    {FilterKind::kTent, "tent"},
    {FilterKind::kGaussian, "gaussian"},
}};

constexpr std::array<std::pair<Heuristic, std::string_view>, 2> kHeuristicNames{{
    {Heuristic::kBalance, "balance"},
    {Heuristic::kPower, "power"},
}};

template <typename Names, typename Value>
std::string_view name_of(const Names& names, Value value) {
  for (const auto& [known, name] : names)
    if (known == value) return name;
  return "unknown";
}

template <typename Value, std::size_t count>
std::optional<Value> value_of(const std::array<std::pair<Value, std::string_view>, count>& names,
                              std::string_view name) {
  for (const auto& [value, known] : names)
    if (known == name) return value;
  return std::nullopt;
}

Status check_side(std::string_view field, int side_px) {
  if (side_px >= 1 && side_px <= kMaxImageSidePx) return {};
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("{}: must be between 1 and {} pixels, got {}", field, kMaxImageSidePx, side_px));
}

}  // namespace

std::string_view integrator_name(Integrator integrator) {
  return name_of(kIntegratorNames, integrator);
}

std::optional<Integrator> integrator_from_name(std::string_view name) {
  return value_of(kIntegratorNames, name);
}

std::string_view heuristic_name(Heuristic heuristic) {
  return name_of(kHeuristicNames, heuristic);
}

std::optional<Heuristic> heuristic_from_name(std::string_view name) {
  return value_of(kHeuristicNames, name);
}

std::string_view filter_name(FilterKind kind) {
  return name_of(kFilterNames, kind);
}

std::optional<FilterKind> filter_from_name(std::string_view name) {
  return value_of(kFilterNames, name);
}

PixelFilter default_filter(FilterKind kind) {
  switch (kind) {
    case FilterKind::kBox:
      return {kind, 0.5f};
    case FilterKind::kTent:
      return {kind, 1};
    case FilterKind::kGaussian:
      return {kind, 1.5f};
  }
  return {};
}

Status check_settings(const RenderSettings& settings) {
  if (auto ok = check_side("width", settings.width_px); !ok) return ok;
  if (auto ok = check_side("height", settings.height_px); !ok) return ok;
  const auto pixels = std::int64_t{settings.width_px} * settings.height_px;
  if (pixels > kMaxImagePixels)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("width x height: {} x {} are {} pixels, more than {}", settings.width_px,
                            settings.height_px, pixels, kMaxImagePixels));
  if (settings.spp < 1 || settings.spp > kMaxSpp)
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("spp: must be between 1 and {} samples per pixel, got {}", kMaxSpp, settings.spp));
  if (settings.max_depth < 0)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("max_depth: must be 0 (no limit) or more, got {}", settings.max_depth));
  if (!(settings.clamp_indirect >= 0 && std::isfinite(settings.clamp_indirect)))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("clamp_indirect: must be 0 (no limit) or a positive number, got {}",
                            settings.clamp_indirect));
  const float radius = settings.filter.radius_px;
  if (!(radius > 0 && radius <= kMaxFilterRadiusPx))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("filter_radius: must be greater than 0 and at most {} pixels, got {}",
                            kMaxFilterRadiusPx, radius));
  if (!settings.layers.valid())
    return fail(ErrorCode::kInvalidArgument, "layers: has a layer that this release does not know");
  if (settings.crop) {
    if (auto ok = check_crop(*settings.crop, settings.width_px, settings.height_px); !ok)
      return fail(ok.error().within("crop"));
  }
  return {};
}

Status check_crop(const PixelRect& crop, int width_px, int height_px) {
  if (!crop.empty() && PixelRect{0, 0, width_px, height_px}.contains(crop)) return {};
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("must be x0, y0, x1, y1 with x0 < x1 and y0 < y1, within the {} x {} pixels of the "
                          "image, got {}, {}, {}, {}",
                          width_px, height_px, crop.x0, crop.y0, crop.x1, crop.y1));
}

Result<RenderSettings> resolve_settings(RenderSettings from_scene, const RenderOverrides& overrides) {
  RenderSettings settings = from_scene;
  settings.width_px = overrides.width_px.value_or(settings.width_px);
  settings.height_px = overrides.height_px.value_or(settings.height_px);
  settings.spp = overrides.spp.value_or(settings.spp);
  settings.seed = overrides.seed.value_or(settings.seed);
  settings.integrator = overrides.integrator.value_or(settings.integrator);
  settings.heuristic = overrides.heuristic.value_or(settings.heuristic);
  settings.clamp_indirect = overrides.clamp_indirect.value_or(settings.clamp_indirect);
  if (overrides.crop) settings.crop = overrides.crop;
  settings.layers = overrides.layers.value_or(settings.layers);
  if (auto ok = check_settings(settings); !ok) return fail(ok.error());
  return settings;
}

}  // namespace tessera::core
