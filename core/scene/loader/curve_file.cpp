// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/curve_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <vector>

#include "core/scene/loader/gunzip.hpp"
#include "core/scene/loader/ply_header.hpp"
#include "core/scene/loader/ply_values.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

tl::unexpected<Error> bad_curves(std::string message) {
  return fail(ErrorCode::kInvalidArgument, std::move(message));
}

// The place of a property that is a single number.
std::optional<std::size_t> find_number(const PlyElement& element, std::string_view name) {
  const auto found = std::find_if(element.properties.begin(), element.properties.end(),
                                  [&](const PlyProperty& p) { return p.name == name && !p.is_list; });
  if (found == element.properties.end()) return std::nullopt;
  return static_cast<std::size_t>(found - element.properties.begin());
}

class CurveFileReader {
 public:
  CurveFileReader(const PlyHeader& header, std::string_view body)
      : header_(header), values_(body, header.encoding) {}

  Result<CurveStrands> read() {
    for (const PlyElement& element : header_.elements) {
      if (element.has_lists())
        return bad_curves(
            fmt::format("has lists in the element {}; a file of curves has none", in_quotes(element.name)));
      if (!values_.may_follow(element.count,
                              values_.is_binary() ? element.row_bytes() : element.properties.size()))
        return bad_curves("is cut short");
      if (auto read = read_element(element); !read) return fail(read.error());
      if (values_.failed()) return bad_curves("is cut short, or has a value that is no number");
    }
    if (strands_.points.empty() || strands_.counts.empty())
      return bad_curves("needs the elements 'vertex' and 'curve'");
    return std::move(strands_);
  }

 private:
  Status read_element(const PlyElement& element) {
    if (element.name == "vertex") {
      if (!strands_.points.empty()) return bad_curves("has two elements 'vertex'");
      const auto radius = find_number(element, "radius");
      strands_.points.reserve(element.count);
      return read_vectors(element, {"x", "y", "z"}, [&](Vec3 p) {
        strands_.points.push_back(p);
        if (radius) strands_.radii.push_back(row_[*radius]);
      });
    }
    if (element.name == "normal")
      return read_vectors(element, {"nx", "ny", "nz"}, [&](Vec3 n) { strands_.normals.push_back(n); });
    if (element.name == "curve") return read_counts(element);
    read_rows(element, [] {});
    return {};
  }

  // Calls use() for each row, whose numbers are in row_.
  template <typename Use>
  void read_rows(const PlyElement& element, const Use& use) {
    row_.assign(element.properties.size(), 0);
    for (std::uint64_t i = 0; i < element.count && !values_.failed(); ++i) {
      for (std::size_t p = 0; p < row_.size(); ++p) row_[p] = values_.next_float(element.properties[p].type);
      use();
    }
  }

  template <typename Use>
  Status read_vectors(const PlyElement& element, const std::array<std::string_view, 3>& names,
                      const Use& use) {
    std::array<std::size_t, 3> places{};
    for (std::size_t i = 0; i < 3; ++i) {
      const auto place = find_number(element, names[i]);
      if (!place)
        return bad_curves(fmt::format("has no property {} of the element {}", in_quotes(names[i]),
                                      in_quotes(element.name)));
      places[i] = *place;
    }
    read_rows(element, [&] { use(Vec3{row_[places[0]], row_[places[1]], row_[places[2]]}); });
    return {};
  }

  Status read_counts(const PlyElement& element) {
    const auto place = find_number(element, "points");
    if (!place) return bad_curves("has no property 'points' of the element 'curve'");
    strands_.counts.reserve(element.count);
    for (std::uint64_t i = 0; i < element.count && !values_.failed(); ++i) {
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const std::int64_t value = values_.next_integer(element.properties[p].type);
        if (p != *place) continue;
        strands_.counts.push_back(static_cast<std::uint32_t>(
            std::clamp<std::int64_t>(value, 0, std::numeric_limits<std::uint32_t>::max())));
      }
    }
    return {};
  }

  const PlyHeader& header_;
  PlyValues values_;
  std::vector<float> row_;
  CurveStrands strands_;
};

Result<CurveStrands> read_plain(std::string_view bytes) {
  const auto header = read_ply_header(bytes);
  if (!header) return fail(header.error());
  return CurveFileReader(*header, bytes.substr(header->size)).read();
}

}  // namespace

Result<CurveStrands> read_curve_file(std::string_view bytes, const std::string& name) {
  const auto named = [&name](const Error& error) {
    return fail(error.code, fmt::format("{} {}", in_quotes(name), error.message));
  };
  std::string content;
  const auto plain = gunzipped(bytes, content);
  if (!plain) return named(plain.error());
  auto strands = read_plain(*plain);
  if (!strands) return named(strands.error());
  return strands;
}

}  // namespace tessera::core
