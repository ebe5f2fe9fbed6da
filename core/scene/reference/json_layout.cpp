// SPDX-License-Identifier: Apache-2.0
#include "core/scene/reference/json_layout.hpp"

namespace tessera::core {
namespace {

constexpr std::size_t kLineLength = 120;

std::string key_text(const OrderedJson& value, const std::string& key) {
  return value.is_object() ? OrderedJson(key).dump() + ": " : std::string();
}

std::string on_one_line(const OrderedJson& value) {
  if (!value.is_structured()) return value.dump();
  std::string text;
  for (const auto& [key, element] : value.items()) {
    if (!text.empty()) text += ", ";
    text += key_text(value, key) + on_one_line(element);
  }
  return value.is_object() ? "{" + text + "}" : "[" + text + "]";
}

}  // namespace

std::string json_layout(const OrderedJson& value, std::size_t indent) {
  std::string line = on_one_line(value);
  if (!value.is_structured() || value.empty() || indent + line.size() + 1 <= kLineLength) return line;
  std::string text;
  const std::string blanks(indent + 2, ' ');
  for (const auto& [key, element] : value.items()) {
    const std::string before = blanks + key_text(value, key);
    const std::string on_line = on_one_line(element);
    const bool fits = before.size() + on_line.size() + 1 <= kLineLength;
    text += (text.empty() ? "" : ",\n") + before + (fits ? on_line : json_layout(element, indent + 2));
  }
  const std::string end = "\n" + std::string(indent, ' ');
  return value.is_object() ? "{\n" + text + end + "}" : "[\n" + text + end + "]";
}

}  // namespace tessera::core
