// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/json_error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

bool is_word(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

bool contains(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

// The token at which the parser failed, as a part of `text`.
std::string_view faulty_token(std::string_view text, const JsonParserError& error) {
  const auto& [end, last_token, message] = error;
  if (contains(message, "unexpected string literal") || contains(message, "unexpected number literal") ||
      contains(message, "number overflow"))
    return text.substr(end - last_token.size(), last_token.size());
  std::size_t begin = std::min(end - 1, text.size());
  if (!contains(message, "invalid literal")) return text.substr(begin, 1);
  while (begin > 0 && is_word(text[begin - 1])) --begin;
  std::size_t word_end = begin;
  while (word_end < text.size() && is_word(text[word_end])) ++word_end;
  return text.substr(begin, std::max<std::size_t>(word_end - begin, 1));
}

using Phrase = std::pair<std::string_view, std::string_view>;

// The second of the first pair whose first is part of `message`.
std::string_view phrase_for(std::string_view message, std::span<const Phrase> phrases,
                            std::string_view otherwise) {
  for (const auto& [part, phrase] : phrases)
    if (contains(message, part)) return phrase;
  return otherwise;
}

// The text after `before`; empty if that is missing.
std::string_view behind(std::string_view message, std::string_view before) {
  const std::size_t begin = message.find(before);
  return begin == std::string_view::npos ? std::string_view{} : message.substr(begin + before.size());
}

// nlohmann's "[json.exception.parse_error.101] parse error at line 1, column 7: syntax error while parsing
// array - unexpected '}'; expected ']'" in plain words.
std::string explain_unexpected(std::string_view message, std::string_view unexpected) {
  constexpr Phrase kDue[] = {{"; expected end of input", "the end of the file"},
                             {"parsing object key", "a key in double quotes"},
                             {"parsing object separator", "':' after the key"},
                             {"parsing object -", "',' or '}'"},
                             {"parsing array", "',' or ']'"}};
  constexpr Phrase kFound[] = {{"end of input", "the end of the file"},
                               {"string literal", "a text"},
                               {"number literal", "a number"},
                               {"true literal", "true"},
                               {"false literal", "false"},
                               {"null literal", "null"}};
  const std::string_view due = phrase_for(message, kDue, "a value");
  const bool closes = unexpected == "'}'" || unexpected == "']'";
  const bool after_comma = closes && (due == "a value" || due == "a key in double quotes");
  return fmt::format("found {} where {} is due{}", phrase_for(unexpected, kFound, unexpected), due,
                     after_comma ? "; is there a ',' too many before it?" : "");
}

std::string explain(std::string_view message, std::string_view token) {
  if (contains(message, "number overflow"))
    return fmt::format("the number {} is too large", in_quotes(token));
  const std::string_view expectation = behind(message, " - unexpected ");
  const std::string_view unexpected = expectation.substr(0, expectation.find(';'));
  if (!unexpected.empty()) return explain_unexpected(message, unexpected);
  const std::string_view reason = behind(message, " - ");  // the lexer's message
  if (reason == "invalid literal")
    return fmt::format("{} is not JSON; texts and keys need double quotes", in_quotes(token));
  if (contains(reason, "missing closing quote") || contains(reason, "U+000A"))
    return "a text has no closing double quote in its line";
  return std::string(reason);
}

Error not_json(std::string_view text, const std::string& file, std::size_t position, std::string_view what) {
  const std::string_view before = text.substr(0, position);
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t column = before.size() - (before.rfind('\n') + 1) + 1;
  return {ErrorCode::kInvalidArgument, fmt::format("{}:{}:{}: not valid JSON: {}", file, line, column, what)};
}

// Removes the lexer's last token, which may contain anything.
JsonParserError without_quotation(JsonParserError error) {
  error.message = error.message.substr(0, error.message.find("; last read: "));
  return error;
}

}  // namespace

Error explain_json_error(std::string_view text, const std::string& file, const JsonParserError& quoting) {
  const JsonParserError error = without_quotation(quoting);
  const std::string_view token = faulty_token(text, error);
  return not_json(text, file, static_cast<std::size_t>(token.data() - text.data()),
                  explain(error.message, token));
}

Error explain_nul(std::string_view text, const std::string& file, std::size_t position) {
  return not_json(text, file, position, "a NUL character");
}

}  // namespace tessera::core
