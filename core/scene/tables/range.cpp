// SPDX-License-Identifier: Apache-2.0
#include "core/scene/tables/range.hpp"

#include <fmt/format.h>

namespace tessera::core {
namespace {

std::string limits_of(const Range& range) {
  const std::string min = limit_text(range.min), max = limit_text(range.max);
  const std::string_view above = range.excludes_min ? "greater than " : "";
  if (range.excludes_zero) return "other than 0";
  if (!range.has_min() && !range.has_max()) return "a number";
  if (!range.has_min()) return (range.excludes_max ? "less than " : "at most ") + max;
  if (!range.has_max()) return range.excludes_min ? fmt::format("greater than {}", min) : min + " or greater";
  if (!range.excludes_min && !range.excludes_max) return fmt::format("between {} and {}", min, max);
  return fmt::format("{}{} and {}{}", above.empty() ? "at least " : above, min,
                     range.excludes_max ? "less than " : "at most ", max);
}

}  // namespace

std::string limit_text(double limit) {
  std::string text = fmt::format("{:.15g}", limit);
  if (const auto plus = text.find("e+"); plus != std::string::npos) text.erase(plus + 1, 1);
  return text;
}

std::string phrase_of(const Range& range) {
  if (!range.phrase.empty()) return std::string(range.phrase);
  return range.unit.empty() ? limits_of(range) : fmt::format("{} {}", limits_of(range), range.unit);
}

}  // namespace tessera::core
