// SPDX-License-Identifier: Apache-2.0
// The numbers that a key of a scene accepts. Plain data and pure functions.
#pragma once

#include <limits>
#include <string>
#include <string_view>

namespace tessera::core {

struct Range {
  double min = -std::numeric_limits<double>::infinity(), max = std::numeric_limits<double>::infinity();
  bool excludes_min = false, excludes_max = false, excludes_zero = false;
  bool or_zero = false;       // 0 is accepted, too
  std::string_view unit{};    // after the limits in messages: "between -64 and 64 stops"
  std::string_view phrase{};  // in messages, instead of what follows from the limits

  constexpr bool contains(double v) const {
    return (or_zero && v == 0) || ((excludes_min ? v > min : v >= min) &&
                                   (excludes_max ? v < max : v <= max) && !(excludes_zero && v == 0));
  }
  constexpr bool has_min() const { return min > -std::numeric_limits<double>::infinity(); }
  constexpr bool has_max() const { return max < std::numeric_limits<double>::infinity(); }
};

// A limit as people write it: 100000, 1e15.
std::string limit_text(double limit);
// After "must be": "between 0 and 1".
std::string phrase_of(const Range& range);

namespace ranges {
inline constexpr Range kAny{};
inline constexpr Range kUnit{.min = 0, .max = 1};
inline constexpr Range kNotNegative{.min = 0};
inline constexpr Range kPositive{.min = 0, .excludes_min = true};
inline constexpr Range kNotZero{.excludes_zero = true};
// Up to kMaxCoordinate.
inline constexpr Range kCoordinate{.min = -1e15, .max = 1e15, .phrase = "a number between -1e15 and 1e15"};
// Up to kMaxTurnDegrees.
inline constexpr Range kDegrees{.min = -3600, .max = 3600};
inline constexpr Range kFrame{.min = -1e6, .max = 1e6, .phrase = "a number between -1000000 and 1000000"};
}  // namespace ranges

}  // namespace tessera::core
