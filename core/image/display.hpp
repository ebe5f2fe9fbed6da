// SPDX-License-Identifier: Apache-2.0
// Converts linear light for 8-bit images: exposure, and a tone curve that compresses bright light into the
// range of a screen. It applies to PNG files only; linear files keep the light unchanged. Stateless;
// thread-safe, and bit-identical on every machine.
#pragma once

#include <optional>
#include <string_view>

#include "core/base/error.hpp"
#include "core/math/rgb.hpp"

namespace tessera::core {

// The tone mapping operators. The white of the output is 1.
enum class ToneCurve {
  kNone,  // unchanged; values above white are clipped
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

// Command-line replacements for the scene file's settings.
struct DisplayOverrides {
  std::optional<float> exposure_stops;
  std::optional<ToneCurve> tone_curve;
};

// Checks that the exposure is within kMaxExposureStops either way. The error names the field.
Status check_display(const DisplaySettings& settings);

// Applies the overrides and checks the result.
Result<DisplaySettings> resolve_display(DisplaySettings from_scene, const DisplayOverrides& overrides);

class DisplayTransform {
 public:
  explicit DisplayTransform(const DisplaySettings& settings);

  // The display-referred light, still linear. Gray stays gray, black stays black, and the mapping of gray
  // is monotonic. With a curve each channel lies in [0, 1]; without one, only exposure is applied.
  Rgb operator()(Rgb light) const;

 private:
  float scale_;
  ToneCurve curve_;
};

}  // namespace tessera::core
