// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/json_document.hpp"

#include <gtest/gtest.h>

namespace tessera::core {
namespace {

// The value, which must parse without mistakes.
JsonValue parse(std::string_view text) {
  Mistakes mistakes("x.json");
  auto value = parse_json(text, "x.json", mistakes);
  EXPECT_TRUE(value.has_value()) << value.error().message;
  EXPECT_TRUE(mistakes.empty());
  return value ? std::move(*value) : JsonValue{};
}

std::string json_error(std::string_view text) {
  Mistakes mistakes("x.json");
  const auto value = parse_json(text, "x.json", mistakes);
  return value ? "no error" : value.error().message;
}

TEST(JsonDocument, KeepsTheLineOfEveryValue) {
  const JsonValue root = parse(
      "// first\n"
      "{ \"a\": 1,\n"
      "  /* over\n"
      "     two lines */ \"b\":\n"
      "    [ true,\n"
      "      12\n"
      "\n"
      "    , \"text\", {\n"
      "    } ],\n"
      "  \"c\": null}\n");
  const auto& members = *root.get_if<JsonValue::Object>();
  ASSERT_EQ(members.size(), 3u);
  EXPECT_EQ(root.line, 2);
  EXPECT_EQ(members[0].key_line, 2);
  EXPECT_EQ(members[0].value.line, 2);
  EXPECT_EQ(members[1].key_line, 4);
  EXPECT_EQ(members[1].value.line, 5);
  const auto& items = *members[1].value.get_if<JsonValue::Array>();
  ASSERT_EQ(items.size(), 4u);
  EXPECT_EQ(items[0].line, 5);
  EXPECT_EQ(items[1].line, 6);  // not 7, though the lexer looks at the line's end before it knows
  EXPECT_EQ(items[2].line, 8);
  EXPECT_EQ(items[3].line, 8);
  EXPECT_EQ(members[2].value.line, 10);
}

TEST(JsonDocument, CountsLinesOfWindowsFiles) {
  const JsonValue root = parse("\xef\xbb\xbf[\r\n1,\r\n2\r\n]\r\n");
  const auto& items = *root.get_if<JsonValue::Array>();
  EXPECT_EQ(items[0].line, 2);
  EXPECT_EQ(items[1].line, 3);
}

TEST(JsonDocument, KnowsWholeNumbers) {
  const JsonValue root = parse("[0, 18446744073709551615, 18446744073709551616, -1, 2.5, 1e3, -0]");
  const auto& items = *root.get_if<JsonValue::Array>();
  const auto whole = [&](std::size_t i) { return items[i].get_if<JsonValue::Number>()->whole; };
  EXPECT_EQ(whole(0), 0u);
  EXPECT_EQ(whole(1), 18446744073709551615u);
  EXPECT_EQ(whole(2), std::nullopt);
  EXPECT_EQ(whole(3), std::nullopt);
  EXPECT_EQ(whole(4), std::nullopt);
  EXPECT_EQ(whole(5), 1000u);
  EXPECT_EQ(whole(6), 0u);
  EXPECT_EQ(items[3].get_if<JsonValue::Number>()->value, -1);
}

TEST(JsonDocument, ExplainsWhatIsNotJson) {
  const std::pair<std::string_view, std::string_view> cases[] = {
      {"", "1:1: not valid JSON: found the end of the file where a value is due"},
      {"{\"a\": 1\n", "2:1: not valid JSON: found the end of the file where ',' or '}' is due"},
      {"{\"a\": red}", "1:7: not valid JSON: 'red' is not JSON; texts and keys need double quotes"},
      {"{\n  a: 1}", "2:3: not valid JSON: 'a' is not JSON; texts and keys need double quotes"},
      {"{'a': 1}", "1:2: not valid JSON: ''' is not JSON; texts and keys need double quotes"},
      {"[NaN]", "1:2: not valid JSON: 'NaN' is not JSON; texts and keys need double quotes"},
      {"[tru]", "1:2: not valid JSON: 'tru' is not JSON; texts and keys need double quotes"},
      {"[1e999]", "1:2: not valid JSON: the number '1e999' is too large"},
      {"[1,]", "1:4: not valid JSON: found ']' where a value is due; is there a ',' too many before it?"},
      {"{\"a\": 1,}",
       "1:9: not valid JSON: found '}' where a key in double quotes is due; is there a ',' too many before "
       "it?"},
      {"[1 2]", "1:4: not valid JSON: found a number where ',' or ']' is due"},
      {"{\"a\": 1 \"b\": 2}", "1:9: not valid JSON: found a text where ',' or '}' is due"},
      {"{\"a\" 1}", "1:6: not valid JSON: found a number where ':' after the key is due"},
      {"{\"a\": 1}}", "1:9: not valid JSON: found '}' where the end of the file is due"},
      {"[\"abc\n\"]", "1:6: not valid JSON: a text has no closing double quote in its line"},
      {"[\"abc", "1:6: not valid JSON: a text has no closing double quote in its line"},
      {"[\"\xff\"]", "1:3: not valid JSON: invalid string: ill-formed UTF-8 byte"},
      {"[\"\\q\"]", "1:4: not valid JSON: invalid string: forbidden character after backslash"},
      {"[1] /* x", "1:9: not valid JSON: invalid comment; missing closing '*/'"},
      {std::string_view("[1]\n\0x", 6), "2:1: not valid JSON: a NUL character"},
  };
  for (const auto& [text, message] : cases)
    EXPECT_EQ(json_error(text), "x.json:" + std::string(message)) << text;
}

// The parser quotes the text in what it says.
TEST(JsonDocument, ExplainsTextsThatReadLikeTheParsersMessages) {
  for (const std::string said : {"number overflow", "unexpected string literal", "invalid literal"}) {
    EXPECT_EQ(json_error("\"" + said + "\n"),
              "x.json:1:" + std::to_string(said.size() + 2) +
                  ": not valid JSON: a text has no closing double quote in its line")
        << said;
  }
}

TEST(JsonDocument, LimitsNesting) {
  EXPECT_EQ(json_error(std::string(32, '[') + std::string(32, ']')), "no error");
  EXPECT_EQ(json_error("\n" + std::string(33, '[') + std::string(33, ']')),
            "x.json:2: lists and objects are nested more than 32 deep");
  EXPECT_EQ(json_error(std::string(1'000'000, '[')),
            "x.json:1: lists and objects are nested more than 32 deep");
}

TEST(JsonDocument, ReportsRepeatedKeys) {
  Mistakes mistakes("x.json");
  ASSERT_TRUE(
      parse_json("{\"a\": 1,\n\"b\": {\"a\": 2,\n\"c\": 3,\n\"a\": 4},\n\"b\": 5}", "x.json", mistakes)
          .has_value());
  EXPECT_EQ(
      mistakes.error().message,
      "x.json:4: the key 'a' is already there in line 2\nx.json:5: the key 'b' is already there in line 2");
}

TEST(JsonDocument, DescribesValues) {
  const JsonValue root = parse("[3, -2.5, \"red\", [1, 2], {}, true, null, 18446744073709551615]");
  std::string all;
  for (const auto& item : *root.get_if<JsonValue::Array>()) all += item.describe() + "; ";
  EXPECT_EQ(all, "3; -2.5; the text 'red'; a list of 2; an object; true; null; 18446744073709551615; ");
}

}  // namespace
}  // namespace tessera::core
