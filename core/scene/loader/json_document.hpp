// SPDX-License-Identifier: Apache-2.0
// JSON as a tree that records the line of every value, for messages. Comments (// and /* */) are allowed;
// repeated keys are not. nlohmann parses; this adds locations.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/base/error.hpp"
#include "core/scene/loader/mistakes.hpp"

namespace tessera::core {

inline constexpr int kMaxJsonDepth = 32;

struct JsonValue {
  struct Number {
    double value = 0;
    std::optional<std::uint64_t> whole;  // the exact value of an integer from 0 to 2^64 - 1
  };
  struct Null {};
  using Array = std::vector<JsonValue>;
  struct Member;
  using Object = std::vector<Member>;  // in the order of the file

  std::variant<Null, bool, Number, std::string, Array, Object> content;
  int line = 0;  // of the value's start, from 1
  // For readers that tell what they did not look at; not thread-safe.
  mutable bool is_used = false;

  template <typename T>
  const T* get_if() const {
    return std::get_if<T>(&content);
  }

  // The value's description in messages: 3, "red", a list of 2, an object, true, null.
  std::string describe() const;
};

struct JsonValue::Member {
  std::string key;
  int key_line = 0;
  JsonValue value;
};

// Errors give line, column and what is expected there: "FILE:3:7: not valid JSON: found '}' where a value
// is due". Repeated keys are added to `mistakes`.
Result<JsonValue> parse_json(std::string_view text, const std::string& file, Mistakes& mistakes);

}  // namespace tessera::core
