// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/ply_values.hpp"

#include <charconv>
#include <limits>
#include <type_traits>

namespace tessera::core {
namespace {

constexpr bool is_space(char c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}

std::int64_t saturated(double value) {
  constexpr double kMax = 9e18;
  return std::isfinite(value) ? static_cast<std::int64_t>(std::clamp(value, -kMax, kMax)) : -1;
}

}  // namespace

std::string_view PlyValues::next_word() {
  std::size_t begin = 0;
  while (begin < rest_.size() && is_space(rest_[begin])) ++begin;
  std::size_t end = begin;
  while (end < rest_.size() && !is_space(rest_[end])) ++end;
  const std::string_view word = rest_.substr(begin, end - begin);
  rest_.remove_prefix(end);
  return word;
}

template <typename T>
T PlyValues::next_number() {
  std::string_view word = next_word();
  if (word.starts_with('+')) word.remove_prefix(1);
  T value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::result_out_of_range) {
    const bool is_tiny = word.find("e-") != word.npos || word.find("E-") != word.npos;
    return is_tiny ? 0 : std::numeric_limits<T>::infinity();
  }
  if (error == std::errc() && end == word.data() + word.size()) return value;
  failed_ = true;
  return 0;
}

const char* PlyValues::take(std::size_t bytes) {
  if (bytes > rest_.size()) {
    failed_ = true;
    rest_ = {};
    return nullptr;
  }
  const char* taken = rest_.data();
  rest_.remove_prefix(bytes);
  return taken;
}

float PlyValues::next_float(PlyType type) {
  if (!is_binary()) return next_number<float>();
  const char* bytes = take(size_of(type));
  if (bytes == nullptr) return 0;
  return with_ply_type(
      type, [&](auto sample) { return ply_float(load_ply_value<decltype(sample)>(bytes, is_swapped())); });
}

std::int64_t PlyValues::next_integer(PlyType type) {
  if (!is_binary()) return saturated(next_number<double>());
  const char* bytes = take(size_of(type));
  if (bytes == nullptr) return 0;
  return with_ply_type(type, [&](auto sample) {
    const auto value = load_ply_value<decltype(sample)>(bytes, is_swapped());
    if constexpr (std::is_floating_point_v<decltype(sample)>)
      return saturated(double{value});
    else
      return static_cast<std::int64_t>(value);
  });
}

void PlyValues::skip(PlyType type, std::uint64_t count) {
  if (!may_follow(count, is_binary() ? size_of(type) : 1)) {
    failed_ = true;
    rest_ = {};
    return;
  }
  if (is_binary()) {
    take(size_of(type) * count);
    return;
  }
  for (; count > 0; --count)
    if (next_word().empty()) failed_ = true;
}

}  // namespace tessera::core
