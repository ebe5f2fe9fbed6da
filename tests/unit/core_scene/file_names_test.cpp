// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/file_names.hpp"

#include <gtest/gtest.h>

namespace tessera::core {
namespace {

TEST(FileNames, AreDecodedFromPercent) {
  EXPECT_EQ(decode_percent("my%20tex%2epng"), "my tex.png");
  EXPECT_EQ(decode_percent("50% %zz%2"), "50% %zz%2");
}

TEST(FileNames, AreDecodedFromWindows1252) {
  EXPECT_EQ(windows_1252_as_utf8("gr\xfcn \x80.png"), "grün €.png");
  EXPECT_EQ(windows_1252_as_utf8("grün.png"), std::nullopt);
}

TEST(FileNames, AreTheSameInAnyCaseAndNormalisation) {
  EXPECT_TRUE(are_same_names("Holz.PNG", "holz.png"));
  EXPECT_TRUE(are_same_names("gr\xc3\xbcn.png", "gru\xcc\x88n.PNG"));
  EXPECT_TRUE(are_same_names("e\xcc\x81\xcc\xa3", "\xe1\xba\xb9"));
  EXPECT_FALSE(are_same_names("gr\xc3\xbcn.png", "grun.png"));
  EXPECT_FALSE(are_same_names("gr\xc3\xbcn", "gr\xc3\xb6n"));
  EXPECT_FALSE(are_same_names("gr\xc3\xbcn.png", "gru\xcc\x88n.jpg"));
  EXPECT_FALSE(are_same_names("a", "ab"));
  EXPECT_FALSE(are_same_names("a/\xcc\x81x", "a\xc3\xa9x")) << "only letters have accents";
}

TEST(FileNames, HaveOneKeyForAllSpellings) {
  EXPECT_EQ(spelling_key("Gr\xc3\xbcn.PNG"), spelling_key("gru\xcc\x88n.png"));
  EXPECT_EQ(spelling_key("a/\xcc\x81"), spelling_key("A/\xcc\x81"));
  EXPECT_NE(spelling_key("gr\xc3\xbcn.png"), spelling_key("grun.png"));
}

}  // namespace
}  // namespace tessera::core
