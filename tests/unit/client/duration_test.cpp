// SPDX-License-Identifier: Apache-2.0
#include "client/duration.hpp"

#include <gtest/gtest.h>

namespace tessera::client {
namespace {

TEST(ParseDuration, AddsUnitsFromTheLargestOn) {
  EXPECT_EQ(parse_duration("90s"), 90);
  EXPECT_EQ(parse_duration("10m"), 600);
  EXPECT_EQ(parse_duration("1h30m"), 5400);
  EXPECT_EQ(parse_duration("2d1s"), 2 * 86400 + 1);
  EXPECT_EQ(parse_duration("0s"), 0);
}

TEST(ParseDuration, RefusesEverythingElse) {
  for (const char* text : {"", "90", "m", "1.5h", "-1m", "+1m", " 1m", "1m ", "1m1h", "1m1m", "1 m", "10ms",
                           "1001d", "99999999999s", "1M"})
    EXPECT_EQ(parse_duration(text), std::nullopt) << text;
}

}  // namespace
}  // namespace tessera::client
