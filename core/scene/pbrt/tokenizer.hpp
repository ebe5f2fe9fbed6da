// SPDX-License-Identifier: Apache-2.0
// Splits a scene file into words, strings and brackets. Not thread-safe.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/base/error.hpp"

namespace tessera::core::pbrt {

struct Token {
  enum class Kind { kEnd, kWord, kString, kOpen, kClose };

  Kind kind = Kind::kEnd;
  std::string_view text;  // of a string: without its quotes, escapes as they are written
  int line = 0;

  bool is(Kind wanted) const { return kind == wanted; }
  // The text of a string with its escapes resolved.
  std::string value() const;
};

std::string without_escapes(std::string_view text);

class Tokenizer {
 public:
  // `text` must outlive this object and its tokens.
  explicit Tokenizer(std::string_view text) : text_(text) {}

  // The next token; kEnd at the end. Fails for a string that does not end. Errors do not name the line, which
  // is line().
  Result<Token> next();
  // The next token without consuming it.
  Result<Token> peek();
  int line() const { return line_; }

 private:
  void skip_blanks();
  Result<Token> scan();
  Result<Token> scan_string();

  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 1;
  std::optional<Token> ahead_;
};

}  // namespace tessera::core::pbrt
