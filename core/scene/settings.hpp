// SPDX-License-Identifier: Apache-2.0
// What a render is asked for: everything besides the scene that a sample may depend on.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "core/base/error.hpp"
#include "core/film/region.hpp"

namespace tessera::core {

// How light is found: by path tracing in three strategies, which have the same expectation, or by ray tracing
// after Whitted. Lights without extent are sampled by all of them: nothing else finds those.
enum class Integrator {
  kNaive,    // only by BSDF samples that happen to meet a light
  kNee,      // next-event estimation: only by sampling lights, but for emission behind mirrors and glass
  kMis,      // both, weighed by a heuristic
  kWhitted,  // only light that comes straight, or by way of mirrors and smooth glass (Whitted 1980)
};

// How multiple importance sampling weighs its strategies (Veach and Guibas 1995).
enum class Heuristic {
  kBalance,
  kPower,  // with the exponent 2
};

std::string_view integrator_name(Integrator integrator);
std::optional<Integrator> integrator_from_name(std::string_view name);
std::string_view heuristic_name(Heuristic heuristic);
std::optional<Heuristic> heuristic_from_name(std::string_view name);

// How light that falls around a pixel's centre counts for the pixel. Each is separable, and zero beyond its
// radius along either axis.
enum class FilterKind {
  kBox,       // all of it alike
  kTent,      // falling off in straight lines
  kGaussian,  // falling off like a normal distribution, cut off at three standard deviations
};

std::string_view filter_name(FilterKind kind);
std::optional<FilterKind> filter_from_name(std::string_view name);

inline constexpr float kMaxFilterRadiusPx = 16;

struct PixelFilter {
  FilterKind kind = FilterKind::kBox;
  float radius_px = 0.5f;

  bool operator==(const PixelFilter&) const = default;
};

// The filter with the radius that suits it.
PixelFilter default_filter(FilterKind kind);

inline constexpr int kMaxImageSidePx = 65536;
inline constexpr std::int64_t kMaxImagePixels = std::int64_t{1} << 30;
inline constexpr std::uint32_t kMaxSpp = 1u << 24;
inline constexpr int kWhittedDepth = 8;
inline constexpr int kMaxDepth = 1024;  // that a scene may ask for

struct RenderSettings {
  int width_px = 512;
  int height_px = 512;
  std::uint32_t spp = 64;  // samples per pixel
  std::uint64_t seed = 0;
  Integrator integrator = Integrator::kMis;
  Heuristic heuristic = Heuristic::kBalance;  // of kMis
  // Longest path in segments after the camera's. 0: kMaxPathDepth, where Russian roulette lets it get so far;
  // kWhittedDepth of kWhitted.
  int max_depth = 0;
  // The most that light which was scattered more than once adds to a channel of a sample; the other channels
  // keep their proportions. Biased: the image gets darker. 0: no limit. kWhitted has no such light.
  float clamp_indirect = 0;
  PixelFilter filter = {};
  // Which pixels of the picture are rendered, and written: what they show is as in the whole picture. Absent:
  // all of them.
  std::optional<PixelRect> crop = {};

  PixelRect window() const { return crop.value_or(PixelRect{0, 0, width_px, height_px}); }
  bool operator==(const RenderSettings&) const = default;
};

// Replacements for what the scene file says, from a command line or a submitted job.
struct RenderOverrides {
  std::optional<int> width_px, height_px;
  std::optional<std::uint32_t> spp;
  std::optional<std::uint64_t> seed;
  std::optional<Integrator> integrator;
  std::optional<Heuristic> heuristic;
  std::optional<float> clamp_indirect;
  std::optional<PixelRect> crop;
};

// Checks the limits above. Errors name the field: "width: must be between 1 and 65536 pixels, got 0".
Status check_settings(const RenderSettings& settings);

// The part of it about `crop`, for a picture of this size. The error does not name the field.
Status check_crop(const PixelRect& crop, int width_px, int height_px);

// Applies the overrides and checks the result.
Result<RenderSettings> resolve_settings(RenderSettings from_scene, const RenderOverrides& overrides);

}  // namespace tessera::core
