// SPDX-License-Identifier: Apache-2.0
#include "core/scene/pbrt/tokenizer.hpp"

#include "core/scene/loader/wording.hpp"

namespace tessera::core::pbrt {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f' || c == '\v' || c == '\0';
}

bool ends_word(char c) {
  return is_blank(c) || c == '"' || c == '[' || c == ']' || c == '#';
}

char unescaped(char c) {
  switch (c) {
    case 'b':
      return '\b';
    case 'f':
      return '\f';
    case 'n':
      return '\n';
    case 'r':
      return '\r';
    case 't':
      return '\t';
    default:
      return c;
  }
}

}  // namespace

std::string Token::value() const {
  return without_escapes(text);
}

std::string without_escapes(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool escape = text[i] == '\\' && i + 1 < text.size();
    result += escape ? unescaped(text[++i]) : text[i];
  }
  return result;
}

void Tokenizer::skip_blanks() {
  while (at_ < text_.size()) {
    if (text_[at_] == '#') {
      while (at_ < text_.size() && text_[at_] != '\n' && text_[at_] != '\r') ++at_;
    } else if (is_blank(text_[at_])) {
      if (text_[at_++] == '\n') ++line_;
    } else {
      return;
    }
  }
}

Result<Token> Tokenizer::next() {
  if (!ahead_) return scan();
  const Token token = *ahead_;
  ahead_.reset();
  return token;
}

Result<Token> Tokenizer::peek() {
  if (!ahead_) {
    const auto token = scan();
    if (!token) return fail(token.error());
    ahead_ = *token;
  }
  return *ahead_;
}

Result<Token> Tokenizer::scan() {
  skip_blanks();
  if (at_ >= text_.size()) return Token{Token::Kind::kEnd, {}, line_};
  const char first = text_[at_];
  if (first == '"') return scan_string();
  const std::size_t begin = at_++;
  if (first == '[') return Token{Token::Kind::kOpen, text_.substr(begin, 1), line_};
  if (first == ']') return Token{Token::Kind::kClose, text_.substr(begin, 1), line_};
  while (at_ < text_.size() && !ends_word(text_[at_])) ++at_;
  return Token{Token::Kind::kWord, text_.substr(begin, at_ - begin), line_};
}

Result<Token> Tokenizer::scan_string() {
  const std::size_t begin = ++at_;
  while (at_ < text_.size() && text_[at_] != '"' && text_[at_] != '\n') at_ += text_[at_] == '\\' ? 2 : 1;
  if (at_ >= text_.size() || text_[at_] != '"') return mistake("a string has no closing quote");
  return Token{Token::Kind::kString, text_.substr(begin, at_++ - begin), line_};
}

}  // namespace tessera::core::pbrt
