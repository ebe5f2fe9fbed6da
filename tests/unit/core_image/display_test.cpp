// SPDX-License-Identifier: Apache-2.0
#include "core/image/display.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "core/image/decode.hpp"
#include "core/image/encode.hpp"
#include "core/image/srgb.hpp"
#include "tests/unit/core_image/test_image.hpp"

namespace tessera::core {
namespace {

using testing::HasSubstr;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNotANumber = std::numeric_limits<float>::quiet_NaN();

Rgb show(Rgb light, ToneCurve curve, float stops = 0) {
  return DisplayTransform({stops, curve})(light);
}

void expect_near(Rgb a, Rgb b, float tolerance) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance) << "channel " << c;
}

TEST(Display, LeavesEveryBitAloneUnlessAsked) {
  for (const float v : {0.0f, -0.0f, -1.0f, 1e-42f, 0.18f, 1.0f, 3e38f, kInfinity, -kInfinity}) {
    EXPECT_EQ(std::bit_cast<std::uint32_t>(show(Rgb::gray(v), ToneCurve::kNone).g),
              std::bit_cast<std::uint32_t>(v));
  }
}

TEST(Display, StopsDoubleTheLight) {
  for (int stops = -40; stops <= 40; ++stops) {
    EXPECT_EQ(show({1, 0.75f, 3}, ToneCurve::kNone, static_cast<float>(stops)),
              Rgb(Rgb{1, 0.75f, 3} * std::ldexp(1.0f, stops)));
  }
  EXPECT_FLOAT_EQ(show(Rgb::gray(1), ToneCurve::kNone, 0.5f).r, 1.41421356f);
  EXPECT_FLOAT_EQ(show(Rgb::gray(1), ToneCurve::kNone, -1.25f).r, 0.420448208f);
}

TEST(Display, ExposureComesBeforeTheCurve) {
  for (const ToneCurve curve : {ToneCurve::kAces, ToneCurve::kAgx})
    EXPECT_EQ(show({0.3f, 0.2f, 0.1f}, curve, 2), show({1.2f, 0.8f, 0.4f}, curve));
}

struct Shown {
  Rgb light, aces, agx;
};

// What the published formulas give, worked out in double precision with the matrices as printed. Their rows
// do not add up to 1 in the last digits, as ours do.
constexpr Shown kPublished[] = {
    {{0.18f, 0.18f, 0.18f}, {0.10559f, 0.10559f, 0.10559f}, {0.21447f, 0.21453f, 0.21454f}},
    {{1, 1, 1}, {0.61912f, 0.61912f, 0.61911f}, {0.58998f, 0.59021f, 0.59022f}},
    {{16, 16, 16}, {0.98994f, 0.98994f, 0.98993f}, {0.99475f, 0.99520f, 0.99523f}},
    {{1, 0.2f, 0.05f}, {0.67407f, 0.14551f, 0.02920f}, {0.65336f, 0.25362f, 0.10788f}},
    {{0, 0, 4}, {0.11153f, 0.00482f, 0.95388f}, {0.28593f, 0.28592f, 0.94450f}},
    {{0.02f, 0.01f, 0.005f}, {0.00290f, 0.00108f, 0.00034f}, {0.01889f, 0.00609f, 0.00183f}},
    {{8, 2, 0.5f}, {1, 0.83186f, 0.56977f}, {0.98098f, 0.76728f, 0.54228f}},
};

TEST(Display, CurvesAreThePublishedOnes) {
  for (const Shown& shown : kPublished) {
    expect_near(show(shown.light, ToneCurve::kAces), shown.aces, 3e-5f);
    expect_near(show(shown.light, ToneCurve::kAgx), shown.agx, 5e-4f);
  }
}

class Curve : public testing::TestWithParam<ToneCurve> {};
INSTANTIATE_TEST_SUITE_P(All, Curve, testing::Values(ToneCurve::kNone, ToneCurve::kAces, ToneCurve::kAgx),
                         [](const auto& curve) { return std::string(tone_curve_name(curve.param)); });

TEST_P(Curve, KeepsGrayGrayAndNeverDarkensWhatIsBrighter) {
  std::uint8_t before = 0;
  for (float v = 1e-6f; v < 1e8f; v *= 1.001f) {
    const Rgb shown = show(Rgb::gray(v), GetParam());
    ASSERT_EQ(shown, Rgb::gray(shown.r)) << v;
    const std::uint8_t code = srgb_encode(shown.r);
    ASSERT_GE(code, before) << v;
    before = code;
  }
  EXPECT_EQ(before, 255) << "bright light is shown white";
}

TEST_P(Curve, ShowsBlackBlack) {
  EXPECT_EQ(srgb_encode(show({}, GetParam()).g), 0);
}

TEST_P(Curve, MakesCodesOfWhatIsNoLight) {
  for (const float v : {-1.0f, -kInfinity, kNotANumber}) {
    EXPECT_EQ(srgb_encode(show(Rgb::gray(v), GetParam()).g), 0) << v;
  }
  for (const float v : {1e20f, 3e38f, kInfinity}) {
    EXPECT_EQ(srgb_encode(show(Rgb::gray(v), GetParam(), 10).g), 255) << v;
  }
}

TEST(Display, CurvesStayWithinTheScreensRange) {
  const Image image = random_image(64, 64, 5);
  for (const ToneCurve curve : {ToneCurve::kAces, ToneCurve::kAgx}) {
    for (const Rgb& pixel : image.pixels) {
      const Rgb shown = show(pixel, curve, 1);
      for (int c = 0; c < 3; ++c) {
        ASSERT_GE(shown[c], 0);
        ASSERT_LE(shown[c], 1);
      }
    }
  }
}

TEST_P(Curve, ReachesPngAndNoLinearFormat) {
  const Image image = random_image(16, 16, 6);
  const DisplaySettings display{-0.5f, GetParam()};
  const Image png = decode_image(encode_image(image, ImageFormat::kPng, display).value()).value();
  const DisplayTransform to_screen(display);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const Rgb shown = to_screen(image.pixels[i]);
    for (int c = 0; c < 3; ++c) ASSERT_EQ(png.pixels[i][c], srgb_decode(srgb_encode(shown[c])));
  }
  for (const ImageFormat linear : {ImageFormat::kExr, ImageFormat::kHdr, ImageFormat::kPfm})
    EXPECT_EQ(encode_image(image, linear, display).value(), encode_image(image, linear).value());
}

TEST(Display, CurvesHaveNames) {
  for (const ToneCurve curve : {ToneCurve::kNone, ToneCurve::kAces, ToneCurve::kAgx})
    EXPECT_EQ(tone_curve_from_name(tone_curve_name(curve)), curve);
  EXPECT_EQ(tone_curve_from_name("filmic"), std::nullopt);
}

TEST(Display, OverridesReplaceWhatIsGiven) {
  const DisplaySettings of_scene{2, ToneCurve::kAgx};
  EXPECT_EQ(resolve_display(of_scene, {}).value(), of_scene);
  EXPECT_EQ(resolve_display(of_scene, {.exposure_stops = -1.0f, .tone_curve = {}}).value(),
            (DisplaySettings{-1, ToneCurve::kAgx}));
  EXPECT_EQ(resolve_display(of_scene, {.exposure_stops = {}, .tone_curve = ToneCurve::kNone}).value(),
            (DisplaySettings{2, ToneCurve::kNone}));
}

TEST(Display, RefusesExposuresThatAreNone) {
  for (const float stops : {64.5f, -65.0f, kInfinity, kNotANumber}) {
    const Status status = check_display({stops, ToneCurve::kNone});
    ASSERT_FALSE(status);
    EXPECT_THAT(status.error().message, HasSubstr("exposure: must be between -64 and 64 stops, got "));
  }
  EXPECT_TRUE(check_display({-64, ToneCurve::kAgx}));
}

}  // namespace
}  // namespace tessera::core
