// SPDX-License-Identifier: Apache-2.0
#include "core/view/stream_query.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <limits>

#include "core/image/limits.hpp"
#include "core/view/tile_pixels.hpp"

namespace tessera::view {
namespace {

tl::unexpected<core::Error> invalid(const std::string& parameter, const std::string& what) {
  return core::fail(core::Error{core::ErrorCode::kInvalidArgument, parameter + ": must be " + what}.with(
      core::ErrorDetails{.field = parameter}));
}

}  // namespace

core::Result<long long> parse_parameter(const std::string& name, const std::string& text, long long least,
                                        long long most) {
  long long number = 0;
  const auto [end, wrong] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (wrong != std::errc() || end != text.data() + text.size() || number < least || number > most)
    return invalid(name, fmt::format("a whole number from {} to {}", least, most));
  return number;
}

core::Result<core::PixelRect> parse_region(const std::string& text) {
  std::array<int, 4> sides{};
  const char* at = text.data();
  const char* const end = text.data() + text.size();
  const auto broken = [] { return invalid("region", "x0,y0,x1,y1 with x0 < x1 and y0 < y1"); };
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const auto [rest, wrong] = std::from_chars(at, end, sides[i]);
    const bool is_last = i + 1 == sides.size();
    if (wrong != std::errc() || sides[i] < 0 || sides[i] > core::kMaxImageSidePx) return broken();
    if (is_last ? rest != end : rest == end || *rest != ',') return broken();
    at = rest + 1;
  }
  const core::PixelRect region{sides[0], sides[1], sides[2], sides[3]};
  if (region.empty()) return broken();
  return region;
}

core::Result<StreamQuery> parse_stream_query(const http::Request& request) {
  StreamQuery query;
  if (const auto text = request.parameter("since"); text && !text->empty()) {
    const auto since = parse_parameter("since", *text, 0, std::numeric_limits<long long>::max());
    if (!since) return core::fail(since.error());
    query.since = static_cast<Revision>(*since);
  }
  if (const auto text = request.parameter("level"); text && !text->empty()) {
    const auto level = parse_parameter("level", *text, 0, kMaxLevel);
    if (!level) return core::fail(level.error());
    query.level = static_cast<int>(*level);
  }
  if (const auto text = request.parameter("region"); text && !text->empty()) {
    const auto region = parse_region(*text);
    if (!region) return core::fail(region.error());
    query.region = *region;
  }
  const auto layer = parse_layer(request.parameter("layer").value_or(""));
  if (!layer) return core::fail(layer.error());
  query.layer = *layer;
  if (const auto format = request.parameter("format"); format && *format != "half")
    return invalid("format", "'half'");
  return query;
}

}  // namespace tessera::view
