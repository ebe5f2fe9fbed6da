// SPDX-License-Identifier: Apache-2.0
#include "core/scene/mitsuba/curve_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <system_error>

namespace tessera::core::mitsuba {
namespace {

constexpr std::string_view kLineBlanks = " \t\r";

// The numbers of a line; nullopt if there are not four.
std::optional<std::array<float, 4>> four_numbers(std::string_view line) {
  std::array<float, 4> numbers{};
  for (float& number : numbers) {
    line.remove_prefix(std::min(line.find_first_not_of(kLineBlanks), line.size()));
    if (line.starts_with('+')) line.remove_prefix(1);
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), number);
    if (error != std::errc() || !std::isfinite(number)) return std::nullopt;
    line.remove_prefix(static_cast<std::size_t>(end - line.data()));
  }
  return numbers;
}

}  // namespace

Result<CurveStrands> read_curve_text(std::string_view text, CurveBasis basis) {
  CurveStrands strands{basis, CurveShape::kRound, {}, {}, {}, {}};
  std::uint32_t count = 0;
  const auto finish_curve = [&]() -> Status {
    if (count == 0) return {};
    if (!segments_of(basis, count))
      return fail(
          ErrorCode::kInvalidArgument,
          fmt::format("has a curve of {} control points, and one needs {}", count, stride_of(basis).points));
    strands.counts.push_back(count);
    count = 0;
    return {};
  };
  for (int line_number = 1; !text.empty(); ++line_number) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    if (line.find_first_not_of(kLineBlanks) == line.npos) {
      if (auto done = finish_curve(); !done) return fail(done.error());
      continue;
    }
    const auto numbers = four_numbers(line);
    if (!numbers)
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("has no control point \"x y z radius\" in line {}", line_number));
    const auto [x, y, z, radius] = *numbers;
    strands.points.push_back({x, y, z});
    strands.radii.push_back(radius);
    ++count;
  }
  if (auto done = finish_curve(); !done) return fail(done.error());
  if (strands.counts.empty()) return fail(ErrorCode::kInvalidArgument, "has no curve");
  return strands;
}

}  // namespace tessera::core::mitsuba
