// SPDX-License-Identifier: Apache-2.0
// Render settings: everything besides the scene that a sample depends on.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "core/base/error.hpp"
#include "core/film/layers.hpp"
#include "core/film/region.hpp"
#include "core/image/limits.hpp"

namespace tessera::core {

// The integrators: path tracing with three strategies of equal expectation, or Whitted ray tracing. All of
// them sample delta lights, which nothing else finds.
enum class Integrator {
  kNaive,    // BSDF sampling only
  kNee,      // next-event estimation: light sampling only, except for emission behind mirrors and glass
  kMis,      // both, combined by multiple importance sampling
  kWhitted,  // direct light only, also through mirrors and smooth glass (Whitted 1980)
};

// The weighting heuristic of multiple importance sampling (Veach and Guibas 1995).
enum class Heuristic {
  kBalance,
  kPower,  // with the exponent 2
};

std::string_view integrator_name(Integrator integrator);
std::optional<Integrator> integrator_from_name(std::string_view name);
std::string_view heuristic_name(Heuristic heuristic);
std::optional<Heuristic> heuristic_from_name(std::string_view name);

// The pixel reconstruction filter. Each type is separable, and zero beyond its radius along either axis.
enum class FilterKind {
  kBox,       // constant
  kTent,      // linear falloff
  kGaussian,  // a normal distribution, truncated at three standard deviations
};

std::string_view filter_name(FilterKind kind);
std::optional<FilterKind> filter_from_name(std::string_view name);

inline constexpr float kMaxFilterRadiusPx = 16;

struct PixelFilter {
  FilterKind kind = FilterKind::kBox;
  float radius_px = 0.5f;

  bool operator==(const PixelFilter&) const = default;
};

// The filter with its default radius.
PixelFilter default_filter(FilterKind kind);

inline constexpr std::uint32_t kMaxSpp = 1u << 24;
inline constexpr int kWhittedDepth = 8;
inline constexpr int kMaxDepth = 1024;  // largest accepted max_depth

struct RenderSettings {
  int width_px = 512;
  int height_px = 512;
  std::uint32_t spp = 64;  // samples per pixel
  std::uint64_t seed = 0;
  Integrator integrator = Integrator::kMis;
  Heuristic heuristic = Heuristic::kBalance;  // of kMis
  // Maximum path length in segments after the camera's. 0 means kMaxPathDepth (paths usually end earlier by
  // Russian roulette), or kWhittedDepth for kWhitted.
  int max_depth = 0;
  // Upper bound on the indirect light in each channel of a sample; the ratios of channels are kept. Biased:
  // it darkens the image. 0 means no limit. It does not apply to kWhitted.
  float clamp_indirect = 0;
  PixelFilter filter = {};
  // The pixels of the image that are rendered and written; they are the same as in the full image. If
  // absent, all are rendered.
  std::optional<PixelRect> crop = {};
  // What the film keeps besides the beauty, which does not depend on it.
  LayerSet layers = {};

  PixelRect window() const { return crop.value_or(PixelRect{0, 0, width_px, height_px}); }
  bool operator==(const RenderSettings&) const = default;
};

// Replacements for the scene file's settings, from a command line or a submitted job.
struct RenderOverrides {
  std::optional<int> width_px{}, height_px{};
  std::optional<std::uint32_t> spp{};
  std::optional<std::uint64_t> seed{};
  std::optional<Integrator> integrator{};
  std::optional<Heuristic> heuristic{};
  std::optional<float> clamp_indirect{};
  std::optional<PixelRect> crop{};
  std::optional<LayerSet> layers{};
};

// Checks the limits above. Errors name the field: "width: must be between 1 and 65536 pixels, got 0".
Status check_settings(const RenderSettings& settings);

// Checks `crop` for an image of this size. The error does not name the field.
Status check_crop(const PixelRect& crop, int width_px, int height_px);

// Applies the overrides and checks the result.
Result<RenderSettings> resolve_settings(RenderSettings from_scene, const RenderOverrides& overrides);

}  // namespace tessera::core
