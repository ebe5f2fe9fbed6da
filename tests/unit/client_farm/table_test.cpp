// SPDX-License-Identifier: Apache-2.0
#include "client/farm/table.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

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

TEST(Table, FitsTheTerminalByShorteningTheWidestNames) {
  const std::vector<Column> columns{{.title = "ID"},
                                    {.title = "NAME", .is_flexible = true},
                                    {.title = "OWNER", .is_flexible = true, .rank = 1},
                                    {.title = "SPP", .align = Align::kRight, .rank = 2}};
  const std::vector<std::vector<std::string>> rows{
      {"0123456789", "a very long name of a job", "somebody", "16"}};
  EXPECT_EQ(format_table(columns, rows, {.columns = 42}),
            "ID          NAME             OWNER     SPP\n"
            "0123456789  a very long na…  somebody   16\n")
      << "no column is left out while names can be shortened";
  EXPECT_EQ(format_table(columns, rows, {.columns = 32}),
            "ID          NAME        OWNER\n"
            "0123456789  a very lo…  somebody\n")
      << "the column of the highest rank goes first";
  EXPECT_EQ(format_table(columns, rows, {.columns = 5}),
            "ID          NAME\n"
            "0123456789  a very …\n")
      << "ids are never cut";
}

TEST(Table, WideCharactersTakeTwoColumns) {
  EXPECT_EQ(format_table({{"N"}, {"X"}}, {{"花瓶", "1"}, {"abc", "2"}}), "N     X\n花瓶  1\nabc   2\n");
}

TEST(Table, ShowsNoControlCharacters) {
  EXPECT_EQ(format_table({{"N"}}, {{"a\x1b[2Jb\n"}}), "N\na\\x1b[2Jb\\x0a\n");
}

TEST(Description, WrapsLongValuesOnTerminals) {
  const std::vector<std::pair<std::string, std::string>> rows{{"job", "1f0c"},
                                                              {"failure", "the file 'a b' is not there"}};
  EXPECT_EQ(format_description(rows), "job      1f0c\nfailure  the file 'a b' is not there\n");
  EXPECT_EQ(format_description(rows, {.columns = 24}),
            "job      1f0c\n"
            "failure  the file 'a b'\n"
            "         is not there\n");
  EXPECT_EQ(format_description({{"scene", "a_long_path/scene.json x"}}, {.columns = 10}),
            "scene  a_long_path/scene.json\n"
            "       x\n")
      << "words are never cut";
}

TEST(Description, ShowsNoControlCharacters) {
  EXPECT_EQ(format_description({{"name", "a\x1b[2Jb\n"}}), "name  a\\x1b[2Jb\\x0a\n");
}

}  // namespace
}  // namespace tessera::client
