// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/wording.hpp"

#include <gtest/gtest.h>

namespace tessera::core {
namespace {

TEST(EditDistance, CountsChanges) {
  EXPECT_EQ(edit_distance("", ""), 0u);
  EXPECT_EQ(edit_distance("", "abc"), 3u);
  EXPECT_EQ(edit_distance("albedo", "albedo"), 0u);
  EXPECT_EQ(edit_distance("albdo", "albedo"), 1u);
  EXPECT_EQ(edit_distance("albeddo", "albedo"), 1u);
  EXPECT_EQ(edit_distance("albado", "albedo"), 1u);
  EXPECT_EQ(edit_distance("abledo", "albedo"), 1u);  // neighbours swapped
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
  EXPECT_EQ(edit_distance("abc", "xyz"), 3u);
}

TEST(Suggestion, NamesTheNearestOrElseAllThereAre) {
  EXPECT_EQ(suggestion("albdo", {"type", "albedo"}), "; did you mean 'albedo'?");
  EXPECT_EQ(suggestion("colour", {"type", "albedo"}), "; known are 'type', 'albedo'");
  EXPECT_EQ(suggestion("lens", {"type", "lens_shift"}), "; did you mean 'lens_shift'?");
  EXPECT_EQ(suggestion("lens", {"lens_radius", "lens_shift"}), "; known are 'lens_radius', 'lens_shift'");
  EXPECT_EQ(suggestion("x", {"only"}), "; known is 'only'");
  EXPECT_EQ(suggestion("x", {}), "");
}

TEST(Suggestion, CopesWithNamesOfAnyLength) {
  const std::string longest(1'000'000, 'a');
  EXPECT_EQ(suggestion(longest, {"albedo"}), "; known is 'albedo'");
  EXPECT_EQ(suggestion("albdo", {longest, "albedo"}), "; did you mean 'albedo'?");
}

TEST(Printable, EscapesWhatIsNotUtf8) {
  EXPECT_EQ(printable("Käse €😀"), "Käse €😀");
  EXPECT_EQ(printable(std::string_view("a\0b\n\x7f", 5)), "a\\x00b\\x0a\\x7f");
  EXPECT_EQ(printable("\xff|\xc3|\xe2\x82|\x80"), "\\xff|\\xc3|\\xe2\\x82|\\x80");
  EXPECT_EQ(printable("\xc0\x80"), "\\xc0\\x80");                    // overlong
  EXPECT_EQ(printable("\xe0\x80\x80"), "\\xe0\\x80\\x80");           // overlong
  EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80");           // half of a surrogate pair
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");  // beyond U+10FFFF
}

TEST(Printable, EscapesWhatSteersATerminal) {
  EXPECT_EQ(printable("a\x1b[2Jb"), "a\\x1b[2Jb");
  EXPECT_EQ(printable("\xc2\x9b|\xc2\xa0"), "\\xc2\\x9b|\xc2\xa0");  // CSI; a space
  EXPECT_EQ(printable("\u202egnp.exe|\u2067"),
            "\\xe2\\x80\\xaegnp.exe|\\xe2\\x81\\xa7");  // from right to left
  EXPECT_EQ(printable("\u2028"), "\\xe2\\x80\\xa8");
  EXPECT_EQ(printable("\u200d\u2060\U0001f469"), "\u200d\u2060\U0001f469");
}

TEST(Printable, KeepsLinesWhereTheyAreMeant) {
  EXPECT_EQ(printable_lines("a\n  b\r\n"), "a\n  b\\x0d\n");
  EXPECT_EQ(printable_lines(""), "");
}

TEST(Printable, IsToldOfEveryText) {
  for (const char* text : {"", "K\u00e4se \u20ac", "no\\xff"}) EXPECT_TRUE(is_printable(text)) << text;
  for (const char* text : {"\n", "a\x7f", "\xc3", "ab\xc2\x85", "\u202e"}) EXPECT_FALSE(is_printable(text));
}

TEST(InQuotes, CutsLongNamesBetweenCharacters) {
  EXPECT_EQ(in_quotes("stone"), "'stone'");
  EXPECT_EQ(in_quotes(std::string(80, 'x')), "'" + std::string(80, 'x') + "'");
  EXPECT_EQ(in_quotes("D:/Artists/Anna Bell/Desktop/Work/Assets/Castle Pack/Export "
                      "Files/final/textures/stone.png"),
            "'D:/Artists/Anna Bell/Des...Assets/Castle Pack/Export Files/final/textures/stone.png'");
  const std::string middle(60, 'x');
  EXPECT_EQ(in_quotes(std::string(23, 'a') + "ä" + middle + "ä" + std::string(55, 'b')),
            "'" + std::string(23, 'a') + "..." + std::string(55, 'b') + "'");
  EXPECT_EQ(in_quotes(std::string(100, '\x80')), "'...'");
}

}  // namespace
}  // namespace tessera::core
