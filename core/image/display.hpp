// SPDX-License-Identifier: Apache-2.0
// From linear light to what an 8-bit picture shows: exposure, and a curve that brings bright light into the
// range of a screen. Of PNG files alone; linear files keep the light as it is. Stateless; thread-safe, and
// the same bits on every machine.
#pragma once

#include <optional>
#include <string_view>

#include "core/base/error.hpp"
#include "core/math/rgb.hpp"

namespace tessera::core {

// How light becomes the light of a screen, whose white is 1.
enum class ToneCurve {
  kNone,  // as it is; what is brighter than white is cut off
  kAces,  // the look of the Academy's reference rendering for a Rec. 709 screen (fit by Hill 2015)
  kAgx,   // Sobotka's AgX, whose bright colours go to white gently (fit by Wrensch 2023)
};

std::string_view tone_curve_name(ToneCurve curve);
std::optional<ToneCurve> tone_curve_from_name(std::string_view name);

inline constexpr float kMaxExposureStops = 64;

struct DisplaySettings {
  float exposure_stops = 0;  // light is multiplied by 2 to this power, before the curve
  ToneCurve tone_curve = ToneCurve::kNone;

  bool operator==(const DisplaySettings&) const = default;
};

// Replacements for what the scene file says.
struct DisplayOverrides {
  std::optional<float> exposure_stops;
  std::optional<ToneCurve> tone_curve;
};

// Whether the exposure lies within kMaxExposureStops either way. The error names the field.
Status check_display(const DisplaySettings& settings);

// Applies the overrides and checks the result.
Result<DisplaySettings> resolve_display(DisplaySettings from_scene, const DisplayOverrides& overrides);

class DisplayTransform {
 public:
  explicit DisplayTransform(const DisplaySettings& settings);

  // The screen's light, still linear. Gray stays gray, black stays black, and brighter gray never becomes
  // darker. With a curve each channel lies in [0, 1]; without one, exposure is all that happens.
  Rgb operator()(Rgb light) const;

 private:
  float scale_;
  ToneCurve curve_;
};

}  // namespace tessera::core
