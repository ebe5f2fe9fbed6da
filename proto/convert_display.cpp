// SPDX-License-Identifier: Apache-2.0
#include "proto/convert_display.hpp"

#include <fmt/format.h>

namespace tessera::proto {

using core::ErrorCode;
using core::fail;

v1::ToneCurve to_proto(core::ToneCurve curve) {
  switch (curve) {
    case core::ToneCurve::kNone:
      return v1::TONE_CURVE_NONE;
    case core::ToneCurve::kAces:
      return v1::TONE_CURVE_ACES;
    case core::ToneCurve::kAgx:
      return v1::TONE_CURVE_AGX;
  }
  return v1::TONE_CURVE_UNSPECIFIED;
}

core::Result<core::ToneCurve> from_proto(v1::ToneCurve curve) {
  switch (curve) {
    case v1::TONE_CURVE_NONE:
      return core::ToneCurve::kNone;
    case v1::TONE_CURVE_ACES:
      return core::ToneCurve::kAces;
    case v1::TONE_CURVE_AGX:
      return core::ToneCurve::kAgx;
    default:
      return fail(
          ErrorCode::kInvalidArgument,
          fmt::format("tone_curve: must be NONE, ACES or AGX, got number {}", static_cast<int>(curve)));
  }
}

v1::DisplaySettings to_proto(const core::DisplaySettings& settings) {
  v1::DisplaySettings message;
  message.set_exposure_stops(settings.exposure_stops);
  message.set_tone_curve(to_proto(settings.tone_curve));
  return message;
}

core::Result<core::DisplaySettings> from_proto(const v1::DisplaySettings& message) {
  core::DisplaySettings settings;
  settings.exposure_stops = message.exposure_stops();
  if (message.tone_curve() != v1::TONE_CURVE_UNSPECIFIED) {
    const core::Result<core::ToneCurve> curve = from_proto(message.tone_curve());
    if (!curve) return fail(curve.error());
    settings.tone_curve = *curve;
  }
  return core::resolve_display(settings, {});
}

v1::DisplayOverrides to_proto(const core::DisplayOverrides& overrides) {
  v1::DisplayOverrides message;
  if (overrides.exposure_stops) message.set_exposure_stops(*overrides.exposure_stops);
  if (overrides.tone_curve) message.set_tone_curve(to_proto(*overrides.tone_curve));
  return message;
}

core::Result<core::DisplayOverrides> from_proto(const v1::DisplayOverrides& message) {
  core::DisplayOverrides overrides;
  if (message.has_exposure_stops()) overrides.exposure_stops = message.exposure_stops();
  if (message.tone_curve() != v1::TONE_CURVE_UNSPECIFIED) {
    const core::Result<core::ToneCurve> curve = from_proto(message.tone_curve());
    if (!curve) return fail(curve.error());
    overrides.tone_curve = *curve;
  }
  return overrides;
}

core::Result<core::DisplaySettings> resolve_display(const v1::DisplaySettings& settings,
                                                    const v1::DisplayOverrides& overrides) {
  const auto display = from_proto(settings);
  if (!display) return fail(display.error());
  const auto replaced = from_proto(overrides);
  if (!replaced) return fail(replaced.error());
  return core::resolve_display(*display, *replaced);
}

}  // namespace tessera::proto
