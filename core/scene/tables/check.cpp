// SPDX-License-Identifier: Apache-2.0
#include "core/scene/tables/check.hpp"

#include <fmt/format.h>

#include <cmath>

namespace tessera::core {
namespace {

bool accepts(const Domain& domain, float value) {
  return std::isfinite(value) && domain.range.contains(double{value});
}

std::string refusal(const Domain& domain, const std::string& value) {
  return fmt::format("must be {}, got {}", phrase_of(domain.range), value);
}

std::string why_not_a_texture(int texture, const NameCounts& counts) {
  return texture < static_cast<int>(counts.textures) ? "" : "there is no such texture";
}

constexpr std::string_view kNoFactor = "must be finite and not negative";

}  // namespace

std::string KeyMistake::text() const {
  return fmt::format("{}{} {}", key, what.starts_with("must") ? "" : ":", what);
}

std::string why_refused(float value, const Domain& domain, const NameCounts&) {
  return accepts(domain, value) ? "" : refusal(domain, fmt::format("{}", value));
}

// A number, or an index whose -1 stands for none.
std::string why_refused(int value, const Domain& domain, const NameCounts& counts) {
  const auto why = [value](std::size_t count, std::string_view kind) {
    return value >= -1 && value < static_cast<int>(count) ? "" : fmt::format("there is no such {}", kind);
  };
  if (domain.names == NamesOf::kTextures) return why(counts.textures, "texture");
  if (domain.names == NamesOf::kMedia) return why(counts.media, "medium");
  if (domain.names == NamesOf::kGrids) return why(counts.grids, "grid");
  return domain.range.contains(double(value)) ? "" : refusal(domain, fmt::format("{}", value));
}

std::string why_refused(Vec2 value, const Domain& domain, const NameCounts&) {
  if (accepts(domain, value.x) && accepts(domain, value.y)) return {};
  return refusal(domain, fmt::format("[{}, {}]", value.x, value.y));
}

std::string why_refused(Vec3 value, const Domain& domain, const NameCounts&) {
  if (accepts(domain, value.x) && accepts(domain, value.y) && accepts(domain, value.z)) return {};
  return refusal(domain, fmt::format("[{}, {}, {}]", value.x, value.y, value.z));
}

std::string why_refused(Rgb value, const Domain& domain, const NameCounts& counts) {
  return why_refused(Vec3{value.r, value.g, value.b}, domain, counts);
}

std::string why_refused(const std::string& value, const Domain& domain, const NameCounts&) {
  return value.empty() || domain.accepts_text(value) ? "" : refusal(domain, fmt::format("'{}'", value));
}

std::string why_refused(const ColorParameter& value, const Domain& domain, const NameCounts& counts) {
  if (value.texture < 0) return why_refused(value.value, domain, counts);
  const auto [r, g, b] = value.value;
  if (!is_finite(value.value) || r < 0 || g < 0 || b < 0) return std::string(kNoFactor);
  return why_not_a_texture(value.texture, counts);
}

std::string why_refused(const ScalarParameter& value, const Domain& domain, const NameCounts& counts) {
  if (value.texture < 0) return why_refused(value.value, domain, counts);
  const bool is_negative = value.value < 0 && !accepts(domain, value.value);
  if (!std::isfinite(value.value) || is_negative) return std::string(kNoFactor);
  return why_not_a_texture(value.texture, counts);
}

}  // namespace tessera::core
