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
  EXPECT_EQ(parse_labels({"--label", "a=b=c"}), (Labels{{"a", "b=c"}}));
}

std::string mistake_in(const std::vector<std::string>& arguments) {
  try {
    parse_labels(arguments);
  } catch (const CLI::ParseError& error) {
    return error.what();
  }
  return "";
}

TEST(LabelOption, NeedsAKey) {
  for (const char* text : {"shot", "=12", ""})
    EXPECT_NE(mistake_in({"--label=" + std::string(text)}).find("--label"), std::string::npos) << text;
}

TEST(LabelOption, HasOneValue) {
  EXPECT_NE(mistake_in({"--label", "a=1", "--label", "b=1", "--label", "a=2"}).find("'a' is given twice"),
            std::string::npos);
}

}  // namespace
}  // namespace tessera::client
