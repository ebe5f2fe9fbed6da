// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/ply_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <utility>

#include "core/scene/loader/text_lines.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

constexpr std::size_t kMaxElements = 64, kMaxProperties = 1024, kMaxImages = 1024;

constexpr std::array<std::pair<std::string_view, PlyType>, 16> kPlyTypes{{
    {"char", PlyType::kInt8},
    {"int8", PlyType::kInt8},
    {"uchar", PlyType::kUint8},
    {"uint8", PlyType::kUint8},
    {"short", PlyType::kInt16},
    {"int16", PlyType::kInt16},
    {"ushort", PlyType::kUint16},
    {"uint16", PlyType::kUint16},
    {"int", PlyType::kInt32},
    {"int32", PlyType::kInt32},
    {"uint", PlyType::kUint32},
    {"uint32", PlyType::kUint32},
    {"float", PlyType::kFloat},
    {"float32", PlyType::kFloat},
    {"double", PlyType::kDouble},
    {"float64", PlyType::kDouble},
}};

std::optional<PlyType> ply_type(std::string_view word) {
  for (const auto& [name, type] : kPlyTypes)
    if (name == word) return type;
  return std::nullopt;
}

class PlyHeaderReader {
 public:
  explicit PlyHeaderReader(std::string_view bytes) : bytes_(bytes), rest_(bytes) {}

  Result<PlyHeader> read();

 private:
  Status statement(std::string_view keyword, std::string_view rest);
  Status format(std::string_view rest);
  Status element(std::string_view rest);
  Status property(std::string_view rest);
  void comment(std::string_view rest);
  tl::unexpected<Error> wrong(std::string_view what) const {
    return fail(ErrorCode::kInvalidArgument, fmt::format("is a broken PLY file (line {}: {})", line_, what));
  }

  std::string_view bytes_, rest_;
  int line_ = 0;
  bool has_format_ = false;
  PlyHeader header_;
};

Result<PlyHeader> PlyHeaderReader::read() {
  ++line_;
  rest_ = without_byte_order_mark(rest_);
  if (trimmed(take_line(rest_)) != "ply")
    return fail(ErrorCode::kInvalidArgument, "is no PLY file: it does not begin with 'ply'");
  while (!rest_.empty()) {
    std::string_view line = take_line(rest_);
    ++line_;
    const std::string_view keyword = take_word(line);
    if (keyword == "end_header") {
      if (!has_format_) return wrong("'format' is missing");
      header_.size = bytes_.size() - rest_.size();
      return std::move(header_);
    }
    if (auto done = statement(keyword, line); !done) return fail(done.error());
  }
  return wrong("'end_header' is missing");
}

Status PlyHeaderReader::statement(std::string_view keyword, std::string_view rest) {
  if (keyword == "format") return format(rest);
  if (keyword == "element") return element(rest);
  if (keyword == "property") return property(rest);
  if (keyword == "comment") comment(rest);
  if (keyword == "comment" || keyword == "obj_info" || keyword.empty()) return {};
  return wrong(fmt::format("{} is not a statement of a header", in_quotes(keyword)));
}

Status PlyHeaderReader::format(std::string_view rest) {
  const std::string_view encoding = take_word(rest);
  has_format_ = true;
  if (encoding == "ascii") {
    header_.encoding = PlyEncoding::kAscii;
  } else if (encoding == "binary_little_endian") {
    header_.encoding = PlyEncoding::kLittleEndian;
  } else if (encoding == "binary_big_endian") {
    header_.encoding = PlyEncoding::kBigEndian;
  } else {
    return wrong(fmt::format("there is no format {}", in_quotes(encoding)));
  }
  return {};
}

Status PlyHeaderReader::element(std::string_view rest) {
  PlyElement element;
  element.name = take_word(rest);
  const std::string_view count = take_word(rest);
  const auto [end, error] = std::from_chars(count.data(), count.data() + count.size(), element.count);
  if (error != std::errc() || end != count.data() + count.size())
    return wrong("'element' must be followed by a name and a number");
  if (header_.elements.size() == kMaxElements) return wrong("there are too many elements");
  header_.elements.push_back(std::move(element));
  return {};
}

Status PlyHeaderReader::property(std::string_view rest) {
  if (header_.elements.empty()) return wrong("'property' must follow an 'element'");
  PlyProperty property;
  std::string_view type = take_word(rest);
  property.is_list = type == "list";
  if (property.is_list) {
    const auto count_type = ply_type(take_word(rest));
    if (!count_type || is_floating_point(*count_type)) return wrong("the count of a list must be an integer");
    property.count_type = *count_type;
    type = take_word(rest);
  }
  const auto value_type = ply_type(type);
  if (!value_type) return wrong(fmt::format("there is no type {}", in_quotes(type)));
  property.type = *value_type;
  property.name = take_word(rest);
  auto& properties = header_.elements.back().properties;
  if (properties.size() == kMaxProperties) return wrong("there are too many properties");
  properties.push_back(std::move(property));
  return {};
}

// MeshLab, Metashape and RealityCapture name images of the base colour in this way.
void PlyHeaderReader::comment(std::string_view rest) {
  const std::string_view keyword = take_word(rest);
  const std::string_view name = without_quotes(trimmed(rest));
  if (keyword == "TextureFile" && !name.empty() && header_.images.size() < kMaxImages)
    header_.images.emplace_back(name);
}

}  // namespace

std::size_t size_of(PlyType type) {
  switch (type) {
    case PlyType::kInt8:
    case PlyType::kUint8:
      return 1;
    case PlyType::kInt16:
    case PlyType::kUint16:
      return 2;
    case PlyType::kInt32:
    case PlyType::kUint32:
    case PlyType::kFloat:
      return 4;
    case PlyType::kDouble:
      return 8;
  }
  return 1;
}

bool PlyElement::has_lists() const {
  return std::ranges::any_of(properties, &PlyProperty::is_list);
}

std::size_t PlyElement::row_bytes() const {
  std::size_t bytes = 0;
  for (const PlyProperty& property : properties)
    bytes += size_of(property.is_list ? property.count_type : property.type);
  return bytes;
}

Result<PlyHeader> read_ply_header(std::string_view bytes) {
  return PlyHeaderReader(bytes).read();
}

}  // namespace tessera::core
