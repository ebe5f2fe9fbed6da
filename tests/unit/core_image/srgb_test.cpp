// SPDX-License-Identifier: Apache-2.0
#include "core/image/srgb.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace tessera::core {
namespace {

// IEC 61966-2-1, clause 5.2, in the C library's extended precision.
long double encode_exactly(long double linear) {
  return linear <= 0.0031308L ? 12.92L * linear : 1.055L * powl(linear, 1 / 2.4L) - 0.055L;
}
int expected_code(float linear) {
  return static_cast<int>(floorl(255 * encode_exactly(linear) + 0.5L));
}
long double decode_exactly(long double encoded) {
  return encoded <= 0.04045L ? encoded / 12.92L : powl((encoded + 0.055L) / 1.055L, 2.4L);
}

TEST(Srgb, EncodingIsCorrectlyRoundedAroundEveryThreshold) {
  for (int code = 0; code < 255; ++code) {
    // Two neighbouring floats between which the code changes, found by halving.
    float below = srgb_decode(static_cast<std::uint8_t>(code));
    float above = srgb_decode(static_cast<std::uint8_t>(code + 1));
    while (std::nextafter(below, std::numeric_limits<float>::infinity()) < above) {
      const float middle = below + (above - below) / 2;
      (srgb_encode(middle) <= code ? below : above) = middle;
    }
    float x = std::fmax(below - 3 * (above - below), 0.0f);
    for (int i = 0; i < 8; ++i, x = std::nextafter(x, std::numeric_limits<float>::infinity())) {
      ASSERT_EQ(srgb_encode(x), expected_code(x)) << "linear value " << x << " near code " << code;
    }
  }
}

TEST(Srgb, EncodingIsCorrectlyRoundedBetweenThresholds) {
  for (float x = 1e-6f; x < 1; x *= 1.0009f) ASSERT_EQ(srgb_encode(x), expected_code(x)) << x;
}

TEST(Srgb, EncodingClampsWhatIsOutOfRange) {
  EXPECT_EQ(srgb_encode(0.0f), 0);
  EXPECT_EQ(srgb_encode(-0.5f), 0);
  EXPECT_EQ(srgb_encode(-std::numeric_limits<float>::infinity()), 0);
  EXPECT_EQ(srgb_encode(std::numeric_limits<float>::quiet_NaN()), 0);
  EXPECT_EQ(srgb_encode(1.0f), 255);
  EXPECT_EQ(srgb_encode(1e30f), 255);
  EXPECT_EQ(srgb_encode(std::numeric_limits<float>::infinity()), 255);
}

// The standard's equations at these codes, worked out with forty decimal digits apart from the code under
// test.
TEST(Srgb, HasTheStandardsValues) {
  struct Row {
    int code;
    float linear;
  };
  constexpr Row kTable[] = {
      {0, 0},
      {1, 0.000303526984f},
      {5, 0.00151763492f},
      {10, 0.00303526984f},  // the last code of the straight part
      {11, 0.00334653576f},
      {12, 0.00367650732f},
      {16, 0.0051815167f},
      {32, 0.0144438436f},
      {48, 0.0295568344f},
      {64, 0.0512694584f},
      {80, 0.0802198203f},
      {96, 0.116970668f},
      {112, 0.162029376f},
      {128, 0.2158605f},
      {144, 0.278894263f},
      {160, 0.3515326f},
      {176, 0.434153636f},
      {188, 0.502886458f},
      {192, 0.527115126f},
      {208, 0.630757136f},
      {224, 0.74540421f},
      {240, 0.871367119f},
      {250, 0.955973353f},
      {254, 0.991102097f},
      {255, 1},
  };
  for (const Row& row : kTable) {
    EXPECT_EQ(srgb_decode(static_cast<std::uint8_t>(row.code)), row.linear) << row.code;
    EXPECT_EQ(srgb_encode(row.linear), row.code);
  }
}

TEST(Srgb, IsNotABarePowerOf22) {
  EXPECT_EQ(srgb_encode(0.001f), 3);   // 255 * 12.92 * 0.001 = 3.29; a power of 2.2 would give 11
  EXPECT_EQ(srgb_encode(0.18f), 118);  // middle gray: 255 * 0.46136 = 117.6
}

TEST(Srgb, DecodingIsTheNearestFloat) {
  for (int code = 0; code < 256; ++code) {
    const auto expected = static_cast<float>(decode_exactly(code / 255.0L));
    ASSERT_EQ(srgb_decode(static_cast<std::uint8_t>(code)), expected) << code;
    ASSERT_EQ(srgb_decode(code / 255.0), expected) << code;
  }
}

TEST(Srgb, EveryCodeSurvivesDecodingAndEncoding) {
  for (int code = 0; code < 256; ++code) {
    ASSERT_EQ(srgb_encode(srgb_decode(static_cast<std::uint8_t>(code))), code);
  }
}

}  // namespace
}  // namespace tessera::core
