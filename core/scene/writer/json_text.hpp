// SPDX-License-Identifier: Apache-2.0
// The text of JSON values that read back as the same bits. Stateless; thread-safe.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/math/rgb.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core::json_text {

// The shortest decimal that the scene loader reads as the same float.
std::string number(float value);
std::string number(std::uint64_t value);
std::string boolean(bool value);
// In quotes. Bytes that are not printable UTF-8 are escaped as core/base/printable.hpp does.
std::string text(std::string_view value);
// The word of an enumerator, by its number.
template <typename Words, typename Enum>
std::string word(const Words& words, Enum value) {
  return text(words[static_cast<std::size_t>(value)]);
}
std::string vector(Vec2 value);
std::string vector(Vec3 value);
// A single number for gray.
std::string color(Rgb value);

// Values on one line: [1, 2].
std::string list(const std::vector<std::string>& values);

// The members of an object, as texts.
class Object {
 public:
  Object& add(std::string_view key, std::string value) {
    members_.emplace_back(key, std::move(value));
    return *this;
  }
  // Leaves out what a reader assumes anyway.
  Object& add_unless(const std::string& otherwise, std::string_view key, std::string value) {
    return value == otherwise ? *this : add(key, std::move(value));
  }
  bool empty() const { return members_.empty(); }

  // { "a": 1, "b": 2 }
  std::string on_one_line() const;
  // One member a line, indented by `indent` blanks and two more.
  std::string on_lines(std::size_t indent) const;

 private:
  std::vector<std::pair<std::string, std::string>> members_;
};

// One value a line, indented as an Object's members.
std::string list_on_lines(const std::vector<std::string>& values, std::size_t indent);

}  // namespace tessera::core::json_text
