// SPDX-License-Identifier: Apache-2.0
#include "core/view/stream_query.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tessera::view {
namespace {

core::Result<StreamQuery> parse(std::map<std::string, std::string> query) {
  http::Request request;
  request.query = std::move(query);
  return parse_stream_query(request);
}

TEST(StreamQuery, IsParsed) {
  const auto query = parse({{"since", "42"}, {"level", "2"}, {"region", "0,10,20,30"}, {"format", "half"}});
  ASSERT_TRUE(query);
  EXPECT_EQ(query->since, 42u);
  EXPECT_EQ(query->level, 2);
  EXPECT_EQ(query->region, (core::PixelRect{0, 10, 20, 30}));
  const auto defaults = parse({});
  ASSERT_TRUE(defaults);
  EXPECT_EQ(defaults->since, 0u);
  EXPECT_FALSE(defaults->region);
}

TEST(StreamQuery, NamesWhatIsWrong) {
  using Case = std::pair<const char*, const char*>;
  for (const auto& [name, value] : {Case{"since", "-1"},
                                    {"since", "x"},
                                    {"level", "7"},
                                    {"level", "1.5"},
                                    {"region", "1,2,3"},
                                    {"region", "0,0,0,5"},
                                    {"region", "1,2,3,4,5"},
                                    {"region", "1 2 3 4"},
                                    {"region", "-1,0,2,2"},
                                    {"region", "0,0,99999999999,1"},
                                    {"format", "float"}}) {
    const auto query = parse({{name, value}});
    ASSERT_FALSE(query) << name << '=' << value;
    EXPECT_EQ(query.error().code, core::ErrorCode::kInvalidArgument);
    EXPECT_EQ(core::details_of(query.error()).field, name);
  }
}

}  // namespace
}  // namespace tessera::view
