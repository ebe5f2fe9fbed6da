// SPDX-License-Identifier: Apache-2.0
#include "core/image/display.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/math/elementary.hpp"

namespace tessera::core {
namespace {

constexpr std::array<std::pair<ToneCurve, std::string_view>, 3> kToneCurveNames{{
    {ToneCurve::kNone, "none"},
    {ToneCurve::kAces, "aces"},
    {ToneCurve::kAgx, "agx"},
}};

constexpr double kLn2 = 0.69314718055994530942;

// Exact for whole stops.
float power_of_two(float stops) {
  const float whole = std::floor(stops);
  const double rest = exp(static_cast<double>(stops - whole) * kLn2);
  return static_cast<float>(std::ldexp(rest, static_cast<int>(whole)));
}

// A matrix with rows that sum to 1, given by its off-diagonal elements: `rg` is the weight of green in red,
// `rb` of blue in red. It is applied to channel differences, so gray keeps its exact bits.
struct WhitePreservingMatrix {
  float rg, rb, gr, gb, br, bg;

  Rgb operator*(Rgb c) const {
    return {c.r + rg * (c.g - c.r) + rb * (c.b - c.r), c.g + gr * (c.r - c.g) + gb * (c.b - c.g),
            c.b + br * (c.r - c.b) + bg * (c.g - c.b)};
  }
};

// Replaces NaN and clamps to [0, limit]. The white point of the curves is far below the limit.
float curve_input(float v) {
  return v > 0 ? std::min(v, 1e6f) : 0;
}

template <typename Function>
Rgb each_channel(Rgb c, Function function) {
  return {function(c.r), function(c.g), function(c.b)};
}

// Hill 2015: transforms to the ACES rendering space, applies a rational fit of the reference rendering and
// output transforms, and transforms back.
Rgb aces(Rgb light) {
  constexpr WhitePreservingMatrix kIn{0.35458f, 0.04823f, 0.07600f, 0.01566f, 0.02840f, 0.13383f};
  constexpr WhitePreservingMatrix kOut{-0.53108f, -0.07367f, -0.10208f, -0.00605f, -0.00327f, -0.07276f};
  return kOut * each_channel(kIn * light, [](float v) {
           return (v * (v + 0.0245786f) - 0.000090537f) / (v * (0.983729f * v + 0.4329510f) + 0.238081f);
         });
}

// Wrensch's fit of AgX's contrast curve, on [0, 1].
float agx_contrast(float x) {
  return (((((15.5f * x - 40.14f) * x + 31.96f) * x - 6.868f) * x + 0.4298f) * x + 0.1191f) * x - 0.00232f;
}

// Wrensch 2023, after Sobotka: desaturates colours, maps each channel's logarithm between two exposures
// through the contrast curve, and restores saturation. The curve's output is encoded with a gamma of 2.2.
Rgb agx(Rgb light) {
  constexpr double kDarkestStops = -12.47393, kBrightestStops = 4.026069;
  constexpr WhitePreservingMatrix kIn{0.0784336f, 0.0792237f, 0.0423282f, 0.0791661f, 0.0423757f, 0.0784336f};
  constexpr WhitePreservingMatrix kOut{-0.0980209f, -0.0990297f, -0.0528969f,
                                       -0.0989612f, -0.0529716f, -0.0980435f};
  const Rgb encoded = kOut * each_channel(kIn * light, [](float v) {
                        const double stops = v > 0 ? log(static_cast<double>(v)) / kLn2 : kDarkestStops;
                        const double place = (stops - kDarkestStops) / (kBrightestStops - kDarkestStops);
                        return agx_contrast(static_cast<float>(std::clamp(place, 0.0, 1.0)));
                      });
  return each_channel(encoded, [](float v) {
    return static_cast<float>(pow(static_cast<double>(std::clamp(v, 0.0f, 1.0f)), 2.2));
  });
}

}  // namespace

std::string_view tone_curve_name(ToneCurve curve) {
  for (const auto& [value, name] : kToneCurveNames)
    if (value == curve) return name;
  return "unknown";
}

std::optional<ToneCurve> tone_curve_from_name(std::string_view name) {
  for (const auto& [value, known] : kToneCurveNames)
    if (known == name) return value;
  return std::nullopt;
}

Status check_display(const DisplaySettings& settings) {
  if (std::fabs(settings.exposure_stops) <= kMaxExposureStops) return {};
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("exposure: must be between -{0} and {0} stops, got {1}", kMaxExposureStops,
                          settings.exposure_stops));
}

Result<DisplaySettings> resolve_display(DisplaySettings from_scene, const DisplayOverrides& overrides) {
  const DisplaySettings settings{overrides.exposure_stops.value_or(from_scene.exposure_stops),
                                 overrides.tone_curve.value_or(from_scene.tone_curve)};
  if (auto ok = check_display(settings); !ok) return fail(ok.error());
  return settings;
}

DisplayTransform::DisplayTransform(const DisplaySettings& settings)
    : scale_(power_of_two(settings.exposure_stops)), curve_(settings.tone_curve) {}

Rgb DisplayTransform::operator()(Rgb light) const {
  const Rgb exposed = light * scale_;
  if (curve_ == ToneCurve::kNone) return exposed;
  const Rgb input = each_channel(exposed, curve_input);
  const Rgb curved = curve_ == ToneCurve::kAces ? aces(input) : agx(input);
  return each_channel(curved, [](float v) { return std::clamp(v, 0.0f, 1.0f); });
}

}  // namespace tessera::core
