// SPDX-License-Identifier: Apache-2.0
#include "core/scene/mitsuba/parameters.hpp"

#include <algorithm>

namespace tessera::core::mitsuba {
namespace {

constexpr std::size_t kMaxParameters = 10000;
constexpr std::size_t kMaxValueBytes = std::size_t{1} << 20;   // with parameters substituted
constexpr std::size_t kMaxSubstituted = std::size_t{1} << 26;  // of all values together

bool is_name_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

std::string name_at_start_of(std::string_view text) {
  const auto end = std::find_if_not(text.begin() + 1, text.end(), is_name_character);
  return std::string(text.begin(), end);
}

}  // namespace

void Parameters::define(std::string_view name, std::string value) {
  const std::string key = "$" + std::string(name);
  for (const auto& [known, text] : longest_first_)
    if (known == key) return;
  if (longest_first_.size() >= kMaxParameters) return;  // told where it is used
  const auto shorter = [&](const auto& parameter) { return parameter.first.size() < key.size(); };
  const auto place = std::find_if(longest_first_.begin(), longest_first_.end(), shorter);
  longest_first_.emplace(place, key, std::move(value));
}

std::string Parameters::value_of(std::string_view name) const {
  const std::string key = "$" + std::string(name);
  for (const auto& [known, text] : longest_first_)
    if (known == key) return text;
  return {};
}

tl::expected<std::string, std::string> Parameters::substitute(std::string_view text) const {
  std::string result;
  while (!text.empty()) {
    const std::size_t dollar = std::min(text.find('$'), text.size());
    const bool escaped = dollar > 0 && dollar < text.size() && text[dollar - 1] == '\\';
    result += text.substr(0, escaped ? dollar - 1 : dollar);
    text.remove_prefix(dollar);
    if (text.empty()) break;
    const auto* parameter = escaped ? nullptr : at_start_of(text);
    if (parameter == nullptr && !escaped) return tl::unexpected<std::string>(name_at_start_of(text));
    result += escaped ? "$" : parameter->second;
    if (!escaped) {
      substituted_ += parameter->second.size();
      used_.insert(parameter->first.substr(1));
    }
    text.remove_prefix(escaped ? 1 : parameter->first.size());
    if (result.size() > kMaxValueBytes || substituted_ > kMaxSubstituted)
      return tl::unexpected<std::string>("");
  }
  return result;
}

const Parameters::Parameter* Parameters::at_start_of(std::string_view text) const {
  const auto fits = [&](const Parameter& parameter) { return text.starts_with(parameter.first); };
  const auto found = std::find_if(longest_first_.begin(), longest_first_.end(), fits);
  return found == longest_first_.end() ? nullptr : &*found;
}

}  // namespace tessera::core::mitsuba
