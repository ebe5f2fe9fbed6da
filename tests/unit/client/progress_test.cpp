// SPDX-License-Identifier: Apache-2.0
#include "client/progress.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace tessera::client {
namespace {

const std::string kErase = "\r\x1b[K";

class Progress : public testing::Test {
 protected:
  ProgressOutput output(bool is_terminal) {
    return {is_terminal, [this] { return columns_; },
            [this](std::string_view text) { written_.emplace_back(text); }};
  }

  int columns_ = 80;
  std::vector<std::string> written_;
};

TEST_F(Progress, ATerminalLineHasABarSpeedAndTimes) {
  ProgressLine line(output(true), 100);
  line.update({.samples_done = 0, .samples_total = 4'000'000, .note = ""}, 100);
  line.update({.samples_done = 1'000'000, .samples_total = 4'000'000, .note = ""}, 102);
  line.finish({.samples_done = 4'000'000, .samples_total = 4'000'000, .note = ""}, 108);
  const std::vector<std::string> expected = {
      kErase + "[>                    ]   0.0%      0 samples/s  0:00 elapsed",
      kErase + "[=====>               ]  25.0%   500k samples/s  0:06 left  0:02 elapsed",
      kErase + "[=====================] 100.0%   500k samples/s  0:08 elapsed", "\n"};
  EXPECT_EQ(written_, expected);
}

TEST_F(Progress, ALongNoteShortensTheBar) {
  ProgressLine line(output(true), 0);
  line.update({.samples_done = 1, .samples_total = 2, .note = "12 workers, 24 tiles out"}, 0);
  EXPECT_EQ(written_.back(),
            kErase + "[======>      ]  50.0%      0 samples/s  0:00 elapsed  12 workers, 24 tiles out");
}

TEST_F(Progress, NarrowTerminalsLoseTheBarThenTheEnd) {
  ProgressLine line(output(true), 0);
  columns_ = 40;
  line.update({.samples_done = 0, .samples_total = 10, .note = ""}, 0);
  columns_ = 12;
  line.update({.samples_done = 5, .samples_total = 10, .note = ""}, 1);
  columns_ = 0;
  line.update({.samples_done = 6, .samples_total = 10, .note = ""}, 2);
  const std::vector<std::string> expected = {kErase + "  0.0%      0 samples/s  0:00 elapsed",
                                             kErase + " 50.0%     ", kErase};
  EXPECT_EQ(written_, expected);
}

TEST_F(Progress, NoLineEverFillsTheTerminal) {
  for (columns_ = 1; columns_ < 200; ++columns_) {
    ProgressLine line(output(true), 0);
    line.update({.samples_done = 1, .samples_total = 3, .note = "2 workers"}, 1);
    ASSERT_LT(written_.back().size() - kErase.size(), static_cast<std::size_t>(columns_));
  }
}

TEST_F(Progress, ATerminalIsRedrawnAtMostTenTimesASecond) {
  ProgressLine line(output(true), 0);
  for (std::uint64_t i = 0; i <= 1000; ++i) {
    line.update({.samples_done = i, .samples_total = 1000, .note = ""}, static_cast<double>(i) / 1024);
  }
  EXPECT_GE(written_.size(), 9u);
  EXPECT_LE(written_.size(), 11u);
}

TEST_F(Progress, PipedOutputGetsALineEveryFiveSecondsAndALastOne) {
  ProgressLine line(output(false), 0);
  for (std::uint64_t second = 0; second <= 12; ++second) {
    line.update({.samples_done = second * 100, .samples_total = 1200, .note = "3 workers"},
                static_cast<double>(second));
  }
  line.finish({.samples_done = 1200, .samples_total = 1200, .note = "3 workers"}, 12);
  const std::vector<std::string> expected = {" 41.7%    100 samples/s  0:07 left  0:05 elapsed  3 workers\n",
                                             " 83.3%    100 samples/s  0:02 left  0:10 elapsed  3 workers\n",
                                             "100.0%    100 samples/s  0:12 elapsed  3 workers\n"};
  EXPECT_EQ(written_, expected);
}

TEST_F(Progress, SpeedIsThatOfTheLastTenSeconds) {
  ProgressLine line(output(false), 0);
  for (std::uint64_t second = 0; second <= 60; ++second) {
    const std::uint64_t done = second < 30 ? second * 1000 : 30'000 + (second - 30) * 10;
    line.update({.samples_done = done, .samples_total = 100'000, .note = ""}, static_cast<double>(second));
  }
  EXPECT_NE(written_.back().find("   10 samples/s"), std::string::npos) << written_.back();
}

TEST_F(Progress, WorkDoneBeforeTheStartDoesNotCountAsSpeed) {
  ProgressLine line(output(false), 0);
  line.update({.samples_done = 900, .samples_total = 1000, .note = ""}, 0);
  line.update({.samples_done = 950, .samples_total = 1000, .note = ""}, 5);
  EXPECT_EQ(written_.back(), " 95.0%     10 samples/s  0:05 left  0:05 elapsed\n");
}

TEST_F(Progress, AStandstillShowsNoTimeLeft) {
  ProgressLine line(output(false), 0);
  line.update({.samples_done = 50, .samples_total = 100, .note = ""}, 0);
  line.update({.samples_done = 50, .samples_total = 100, .note = ""}, 20);
  EXPECT_EQ(written_.back(), " 50.0%      0 samples/s  0:20 elapsed\n");
}

TEST_F(Progress, ErasingMakesRoomOnceAndTheNextUpdateDraws) {
  ProgressLine line(output(true), 0);
  line.update({.samples_done = 1, .samples_total = 2, .note = ""}, 0);
  line.erase();
  line.erase();
  EXPECT_EQ(written_.size(), 2u);
  EXPECT_EQ(written_.back(), kErase);
  line.update({.samples_done = 1, .samples_total = 2, .note = ""}, 0.01);
  EXPECT_EQ(written_.size(), 3u);
}

TEST_F(Progress, NothingToDoIsNoDivisionByZero) {
  ProgressLine line(output(false), 0);
  line.finish({}, 0);
  EXPECT_EQ(written_.back(), "  0.0%      0 samples/s  0:00 elapsed\n");
}

TEST(FormatCount, KeepsThreeDigits) {
  EXPECT_EQ(format_count(0), "0");
  EXPECT_EQ(format_count(999.4), "999");
  EXPECT_EQ(format_count(999.5), "1.00k");
  EXPECT_EQ(format_count(1234), "1.23k");
  EXPECT_EQ(format_count(9994), "9.99k");
  EXPECT_EQ(format_count(9996), "10.0k");
  EXPECT_EQ(format_count(99960), "100k");
  EXPECT_EQ(format_count(999'600), "1.00M");
  EXPECT_EQ(format_count(45.6e6), "45.6M");
  EXPECT_EQ(format_count(7.89e9), "7.89G");
  EXPECT_EQ(format_count(1e16), "10000T");
}

TEST(FormatDuration, GrowsUnits) {
  EXPECT_EQ(format_duration(-1), "0:00");
  EXPECT_EQ(format_duration(7.4), "0:07");
  EXPECT_EQ(format_duration(59.6), "1:00");
  EXPECT_EQ(format_duration(754), "12:34");
  EXPECT_EQ(format_duration(3723), "1:02:03");
  EXPECT_EQ(format_duration(86400 * 3 + 3600 * 4), "3d 4h");
  EXPECT_EQ(format_duration(1e300), "1000d 0h");
}

}  // namespace
}  // namespace tessera::client
