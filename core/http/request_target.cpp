// SPDX-License-Identifier: Apache-2.0
#include "core/http/request_target.hpp"

#include <charconv>
#include <utility>

namespace tessera::http {
namespace {

// The byte of the two hexadecimal digits after a percent sign.
std::optional<char> escaped_byte(std::string_view digits) {
  unsigned value = 0;
  const auto [end, wrong] = std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
  if (digits.size() != 2 || wrong != std::errc() || end != digits.data() + digits.size()) return std::nullopt;
  if (value < 0x20 || value == 0x7f) return std::nullopt;
  return static_cast<char>(value);
}

std::optional<std::string> decode(std::string_view text, bool plus_is_space) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%') {
      const auto byte = escaped_byte(text.substr(i + 1, 2));
      if (!byte) return std::nullopt;
      decoded += *byte;
      i += 2;
    } else {
      decoded += plus_is_space && text[i] == '+' ? ' ' : text[i];
    }
  }
  return decoded;
}

bool add_parameter(std::string_view parameter, std::map<std::string, std::string>& query) {
  if (parameter.empty()) return true;
  const std::size_t equals = parameter.find('=');
  auto name = decode(parameter.substr(0, equals), true);
  auto value = equals == std::string_view::npos ? std::string() : decode(parameter.substr(equals + 1), true);
  if (!name || !value) return false;
  query.emplace(std::move(*name), std::move(*value));
  return true;
}

}  // namespace

std::optional<RequestTarget> parse_target(std::string_view target) {
  const std::size_t question = target.find('?');
  auto path = decode(target.substr(0, question), false);
  if (!path || !path->starts_with('/')) return std::nullopt;
  RequestTarget parsed{std::move(*path), {}};
  std::string_view rest = question == std::string_view::npos ? "" : target.substr(question + 1);
  while (!rest.empty()) {
    const std::size_t end = rest.find('&');
    if (!add_parameter(rest.substr(0, end), parsed.query)) return std::nullopt;
    rest = end == std::string_view::npos ? "" : rest.substr(end + 1);
  }
  return parsed;
}

}  // namespace tessera::http
