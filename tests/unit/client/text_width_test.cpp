// SPDX-License-Identifier: Apache-2.0
#include "client/text_width.hpp"

#include <gtest/gtest.h>

namespace tessera::client {
namespace {

TEST(TextWidth, CountsColumnsAndNotBytes) {
  EXPECT_EQ(text_width(""), 0u);
  EXPECT_EQ(text_width("vase"), 4u);
  EXPECT_EQ(text_width("Gefäß"), 5u);
  EXPECT_EQ(text_width("花瓶"), 4u) << "wide characters take two columns";
  EXPECT_EQ(text_width("e\u0301"), 1u) << "a combining accent takes none";
}

TEST(TextWidth, ShortensToColumns) {
  EXPECT_EQ(shortened("vase", 4), "vase");
  EXPECT_EQ(shortened("vases", 4), "vas…");
  EXPECT_EQ(shortened("花瓶花瓶", 4), "花…") << "half of a wide character cannot be shown";
  EXPECT_EQ(shortened("vase", 1), "…");
  EXPECT_EQ(shortened("vase", 0), "");
}

}  // namespace
}  // namespace tessera::client
