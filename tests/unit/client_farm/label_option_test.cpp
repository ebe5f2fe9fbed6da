// SPDX-License-Identifier: Apache-2.0
#include "client/farm/label_option.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace tessera::client {
namespace {

Labels parse_labels(std::vector<std::string> arguments) {
  CLI::App app;
  Labels labels;
  add_label_option(app, "what", labels);
  app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  return labels;
}

TEST(LabelOption, CanBeRepeated) {
  EXPECT_EQ(parse_labels({}), Labels{});
  EXPECT_EQ(parse_labels({"--label", "shot=12", "--label=show=a vase", "--label", "empty="}),
            (Labels{{"shot", "12"}, {"show", "a vase"}, {"empty", ""}}));
  EXPECT_EQ(parse_labels({"--label", "a=1", "--label", "a=b=c"}), (Labels{{"a", "b=c"}}));
}

TEST(LabelOption, NeedsAKey) {
  for (const char* text : {"shot", "=12", ""}) {
    try {
      parse_labels({"--label=" + std::string(text)});
      ADD_FAILURE() << text;
    } catch (const CLI::ParseError& error) {
      EXPECT_NE(std::string(error.what()).find("--label"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace tessera::client
