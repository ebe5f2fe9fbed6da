// SPDX-License-Identifier: Apache-2.0
#include "proto/convert_display.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace tessera::proto {
namespace {

using ::testing::HasSubstr;

TEST(ConvertDisplay, SettingsComeBackAsTheyWere) {
  for (const core::ToneCurve curve :
       {core::ToneCurve::kNone, core::ToneCurve::kAces, core::ToneCurve::kAgx}) {
    const core::DisplaySettings settings{-1.75f, curve};
    EXPECT_EQ(from_proto(to_proto(settings)).value(), settings);
  }
}

TEST(ConvertDisplay, JobsStoredWithoutSettingsAreShownPlainly) {
  EXPECT_EQ(from_proto(v1::DisplaySettings()).value(), core::DisplaySettings{});
}

TEST(ConvertDisplay, SettingsThatCannotBeNameTheField) {
  v1::DisplaySettings exposure, curve;
  curve.set_tone_curve(static_cast<v1::ToneCurve>(99));
  EXPECT_THAT(from_proto(curve).error().message,
              HasSubstr("tone_curve: must be NONE, ACES or AGX, got number 99"));
  for (const float stops : {65.0f, -65.0f, std::numeric_limits<float>::quiet_NaN()}) {
    exposure.set_exposure_stops(stops);
    EXPECT_THAT(from_proto(exposure).error().message, HasSubstr("exposure: must be between"));
  }
}

TEST(ConvertDisplay, AbsentOverridesStayAbsent) {
  const core::DisplayOverrides none = from_proto(to_proto(core::DisplayOverrides{})).value();
  EXPECT_FALSE(none.exposure_stops || none.tone_curve);
  const core::DisplayOverrides all{.exposure_stops = 0.0f, .tone_curve = core::ToneCurve::kNone};
  const core::DisplayOverrides back = from_proto(to_proto(all)).value();
  EXPECT_EQ(back.exposure_stops, 0.0f);
  EXPECT_EQ(back.tone_curve, core::ToneCurve::kNone);
}

TEST(ConvertDisplay, OverridesReplaceWhatTheJobSays) {
  const v1::DisplaySettings of_job = to_proto(core::DisplaySettings{2, core::ToneCurve::kAgx});
  v1::DisplayOverrides overrides;
  EXPECT_EQ(resolve_display(of_job, overrides).value(), (core::DisplaySettings{2, core::ToneCurve::kAgx}));
  overrides.set_exposure_stops(-3);
  EXPECT_EQ(resolve_display(of_job, overrides).value(), (core::DisplaySettings{-3, core::ToneCurve::kAgx}));
  overrides.set_tone_curve(v1::TONE_CURVE_ACES);
  EXPECT_EQ(resolve_display(of_job, overrides).value(), (core::DisplaySettings{-3, core::ToneCurve::kAces}));
  overrides.set_exposure_stops(100);
  EXPECT_EQ(resolve_display(of_job, overrides).error().code, core::ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace tessera::proto
