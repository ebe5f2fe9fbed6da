// SPDX-License-Identifier: Apache-2.0
#include "client/farm/table.hpp"

#include <gtest/gtest.h>

namespace tessera::client {
namespace {

TEST(Table, AlignsItsColumns) {
  EXPECT_EQ(
      format_table({{"NAME"}, {"SPP", Align::kRight}, {"STATE"}}, {{"a", "16", "done"}, {"longer", "4", ""}}),
      "NAME    SPP  STATE\n"
      "a        16  done\n"
      "longer    4\n");
}

TEST(Table, WithoutRowsHasItsTitles) {
  EXPECT_EQ(format_table({{"A"}, {"B"}}, {}), "A  B\n");
}

TEST(Table, CountsLettersNotBytes) {
  EXPECT_EQ(format_table({{"N"}, {"X"}}, {{"\u00e9t\u00e9", "1"}, {"abc", "2"}}),
            "N    X\n\u00e9t\u00e9  1\nabc  2\n");
}

TEST(Table, ShowsNoControlCharacters) {
  EXPECT_EQ(format_table({{"N"}}, {{"a\x1b[2Jb\n"}}), "N\na\\x1b[2Jb\\x0a\n");
}

}  // namespace
}  // namespace tessera::client
