// SPDX-License-Identifier: Apache-2.0
#include "core/scene/writer/json_text.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "core/base/printable.hpp"

namespace tessera::core::json_text {
namespace {

// Joins texts, with `first` before, `between` and `last` after them.
std::string join(const std::vector<std::string>& parts, std::string_view first, std::string_view between,
                 std::string_view last) {
  std::string joined(first);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (i > 0) joined += between;
    joined += parts[i];
  }
  return joined += last;
}

std::vector<std::string> lines_of(const std::vector<std::pair<std::string, std::string>>& members) {
  std::vector<std::string> lines;
  for (const auto& [key, value] : members) lines.push_back(fmt::format("{}: {}", text(key), value));
  return lines;
}

std::string on_indented_lines(const std::vector<std::string>& parts, char open, char close,
                              std::size_t indent) {
  if (parts.empty()) return {open, close};
  const std::string line = "\n" + std::string(indent + 2, ' ');
  return join(parts, open + line, "," + line, "\n" + std::string(indent, ' ') + close);
}

}  // namespace

// Readers convert by way of double, which rounds twice.
std::string number(float value) {
  if (value == 0) return std::signbit(value) ? "-0.0" : "0";
  std::string shortest = fmt::format("{}", value);
  double read = 0;
  std::from_chars(shortest.data(), shortest.data() + shortest.size(), read);
  return static_cast<float>(read) == value ? shortest : fmt::format("{:.9g}", value);
}

std::string number(std::uint64_t value) {
  return fmt::format("{}", value);
}

std::string boolean(bool value) {
  return value ? "true" : "false";
}

std::string text(std::string_view value) {
  std::string quoted = "\"";
  for (const char c : printable(value)) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted += '"';
}

std::string vector(Vec2 value) {
  return list({number(value.x), number(value.y)});
}

std::string vector(Vec3 value) {
  return list({number(value.x), number(value.y), number(value.z)});
}

std::string color(Rgb value) {
  if (value == Rgb::gray(value.r)) return number(value.r);
  return list({number(value.r), number(value.g), number(value.b)});
}

std::string list(const std::vector<std::string>& values) {
  return join(values, "[", ", ", "]");
}

std::string Object::on_one_line() const {
  return members_.empty() ? "{}" : join(lines_of(members_), "{ ", ", ", " }");
}

std::string Object::on_lines(std::size_t indent) const {
  return on_indented_lines(lines_of(members_), '{', '}', indent);
}

std::string list_on_lines(const std::vector<std::string>& values, std::size_t indent) {
  return on_indented_lines(values, '[', ']', indent);
}

}  // namespace tessera::core::json_text
