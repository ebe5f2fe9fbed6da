// SPDX-License-Identifier: Apache-2.0
// What every reader of outside bytes promises besides not to crash.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <string>

#include "core/base/error.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::fuzz {

[[noreturn]] inline void broken(const std::string& promise) {
  std::fprintf(stderr, "broken promise: %s\n", promise.c_str());
  std::abort();
}

inline void expect(bool holds, const std::string& promise) {
  if (!holds) broken(promise);
}

// Messages say something, in text that can be printed, and sent in a field of type string.
inline void expect_message(const std::string& message) {
  expect(!message.empty(), "an error says what is wrong");
  std::string without_line_breaks = message;
  for (char& c : without_line_breaks)
    if (c == '\n') c = ' ';
  expect(core::printable(without_line_breaks) == without_line_breaks, "a message is printable: " + message);
}

template <typename T>
bool expect_answer(const core::Result<T>& result) {
  if (!result) expect_message(result.error().message);
  return result.has_value();
}

}  // namespace tessera::fuzz
