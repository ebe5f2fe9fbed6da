// SPDX-License-Identifier: Apache-2.0
#include "core/scene/mitsuba/parse_values.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>

#include "core/base/letter_case.hpp"

namespace tessera::core::mitsuba {
namespace {

constexpr std::string_view kBlanks = " \t\r\n";

bool is_lower(char c) {
  return c >= 'a' && c <= 'z';
}
bool is_upper(char c) {
  return c >= 'A' && c <= 'Z';
}

std::string_view without_blanks(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

template <typename Number>
std::optional<Number> parse_whole(std::string_view text) {
  text = without_blanks(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  Number value{};
  const char* const last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), last, value);
  if (error != std::errc() || end != last || text.empty()) return std::nullopt;
  return value;
}

// Sorts by wavelength; of several at one wavelength the first stays.
Samples in_order(Samples samples) {
  std::stable_sort(samples.begin(), samples.end(),
                   [](const spectra::SpectralSample& a, const spectra::SpectralSample& b) {
                     return a.wavelength_nm < b.wavelength_nm;
                   });
  const auto same = [](const spectra::SpectralSample& a, const spectra::SpectralSample& b) {
    return a.wavelength_nm == b.wavelength_nm;
  };
  samples.erase(std::unique(samples.begin(), samples.end(), same), samples.end());
  return samples;
}

}  // namespace

std::optional<double> parse_number(std::string_view text) {
  const auto value = parse_whole<double>(text);
  constexpr double kLargest = static_cast<double>(std::numeric_limits<float>::max());
  if (!value || !std::isfinite(*value) || std::fabs(*value) > kLargest) return std::nullopt;
  return value;
}

std::optional<std::int64_t> parse_integer(std::string_view text) {
  return parse_whole<std::int64_t>(text);
}

std::optional<bool> parse_boolean(std::string_view text) {
  const std::string word = in_lower_case(without_blanks(text));
  if (word == "true") return true;
  if (word == "false") return false;
  return std::nullopt;
}

std::vector<std::string_view> split_list(std::string_view text) {
  constexpr std::string_view kSeparators = " \t\r\n,";
  std::vector<std::string_view> words;
  for (std::size_t at = text.find_first_not_of(kSeparators); at != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(kSeparators, at), text.size());
    words.push_back(text.substr(at, end - at));
    at = text.find_first_not_of(kSeparators, end);
  }
  return words;
}

std::optional<std::vector<double>> parse_numbers(std::string_view text) {
  std::vector<double> numbers;
  for (const std::string_view word : split_list(text)) {
    const auto number = parse_number(word);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

std::optional<Vec3> parse_triple(std::string_view text) {
  const auto numbers = parse_numbers(text);
  if (!numbers || (numbers->size() != 1 && numbers->size() != 3)) return std::nullopt;
  const auto at = [&](std::size_t i) { return static_cast<float>((*numbers)[numbers->size() == 1 ? 0 : i]); };
  return Vec3{at(0), at(1), at(2)};
}

std::optional<Vec3> parse_hexadecimal(std::string_view text) {
  text = without_blanks(text);
  std::uint32_t code = 0;
  if (text.size() != 7 || text.front() != '#') return std::nullopt;
  const auto [end, error] = std::from_chars(text.data() + 1, text.data() + text.size(), code, 16);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  const auto channel = [code](int shift) { return static_cast<float>(code >> shift & 255u) / 255; };
  return Vec3{channel(16), channel(8), channel(0)};
}

std::optional<Samples> parse_samples(std::string_view text) {
  Samples samples;
  for (const std::string_view word : split_list(text)) {
    const std::size_t colon = word.find(':');
    if (colon == std::string_view::npos) return std::nullopt;
    const auto wavelength = parse_number(word.substr(0, colon)), value = parse_number(word.substr(colon + 1));
    if (!wavelength || !value) return std::nullopt;
    samples.push_back({*wavelength, *value});
  }
  if (samples.empty()) return std::nullopt;
  return in_order(std::move(samples));
}

std::optional<Samples> parse_sample_file(std::string_view text) {
  Samples samples;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    line = without_blanks(line.substr(0, line.find('#')));
    if (line.empty()) continue;
    const auto numbers = parse_numbers(line);
    if (!numbers || numbers->size() != 2) return std::nullopt;
    samples.push_back({(*numbers)[0], (*numbers)[1]});
  }
  if (samples.empty()) return std::nullopt;
  return in_order(std::move(samples));
}

std::string in_snake_case(std::string_view name) {
  std::string snake;
  for (std::size_t i = 0; i < name.size(); ++i) {
    if (i == 0 || !is_lower(name[i - 1]) || !is_upper(name[i])) {
      snake += name[i];
      continue;
    }
    snake += '_';
    snake += in_lower_case(name[i]);
    while (i + 1 < name.size() && is_upper(name[i + 1])) snake += in_lower_case(name[++i]);
  }
  return snake;
}

}  // namespace tessera::core::mitsuba
