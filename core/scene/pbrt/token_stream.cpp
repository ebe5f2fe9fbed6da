// SPDX-License-Identifier: Apache-2.0
#include "core/scene/pbrt/token_stream.hpp"

#include "core/scene/loader/text_lines.hpp"

namespace tessera::core::pbrt {

TokenStream::File::File(SourceText source)
    : path(std::make_shared<const std::string>(std::move(source.path))),
      content(std::move(source.content)),
      tokens(without_byte_order_mark(content)) {}

void TokenStream::include(SourceText source) {
  open_.push_back(std::make_unique<File>(std::move(source)));
}

bool TokenStream::close_ended(const Result<Token>& token) {
  line_ = token ? token->line : open_.back()->tokens.line();
  if (!token || !token->is(Token::Kind::kEnd) || open_.size() == 1) return false;
  ended_.push_back(std::move(open_.back()));
  open_.pop_back();
  return true;
}

Result<Token> TokenStream::next() {
  auto token = open_.back()->tokens.next();
  while (close_ended(token)) token = open_.back()->tokens.next();
  return token;
}

Result<Token> TokenStream::peek() {
  auto token = open_.back()->tokens.peek();
  while (close_ended(token)) token = open_.back()->tokens.peek();
  return token;
}

}  // namespace tessera::core::pbrt
