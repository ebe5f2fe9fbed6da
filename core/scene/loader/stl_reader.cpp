// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "core/base/letter_case.hpp"
#include "core/scene/loader/mesh_file.hpp"
#include "core/scene/loader/obj_reader.hpp"
#include "core/scene/loader/ply_values.hpp"
#include "core/scene/loader/stl_colors.hpp"
#include "core/scene/loader/text_lines.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

constexpr std::size_t kStlTextBytes = 80, kStlHeaderBytes = 84, kStlTriangleBytes = 50;
constexpr std::uint64_t kMinStlShare = 10;   // at least one triangle in this many must be there
constexpr std::size_t kStlHeadBytes = 4096;  // those that tell text from binary files
constexpr bool kStlIsSwapped = std::endian::native == std::endian::big;

std::uint64_t stl_triangle_count(std::string_view bytes) {
  return bytes.size() < kStlHeaderBytes
             ? 0
             : load_ply_value<std::uint32_t>(bytes.data() + kStlTextBytes, kStlIsSwapped);
}

bool is_binary_stl(std::string_view bytes) {
  return bytes.size() >= kStlHeaderBytes &&
         bytes.size() == kStlHeaderBytes + kStlTriangleBytes * stl_triangle_count(bytes);
}

// A binary header may begin with "solid", too, but the count after it has zero bytes.
bool is_text_stl(std::string_view text) {
  std::string_view head = trimmed(text.substr(0, kStlHeadBytes));
  while (head.starts_with('\n') || head.starts_with('\r')) head = trimmed(head.substr(1));
  if (head.find('\0') != std::string_view::npos) return false;
  const std::string lower = in_lower_case(head);
  return lower.starts_with("facet") ||
         (lower.starts_with("solid") &&
          (lower.find("facet") != std::string::npos || lower.find("endsolid") != std::string::npos));
}

// Gives equal positions with equal tags the same number, by open addressing. `expected` bounds their number.
class PositionIndex {
 public:
  PositionIndex(std::vector<Vec3>& positions, std::size_t expected)
      : positions_(positions), slots_(std::bit_ceil(2 * expected + 2), kEmpty) {}

  std::uint32_t number(Vec3 p, std::uint16_t tag = 0) {
    const Vec3 key{p.x + 0.0f, p.y + 0.0f, p.z + 0.0f};  // no negative zeros
    for (std::size_t i = hash(key, tag) & (slots_.size() - 1);; i = (i + 1) & (slots_.size() - 1)) {
      if (slots_[i] == kEmpty) {
        slots_[i] = static_cast<std::uint32_t>(positions_.size());
        positions_.push_back(key);
        tags_.push_back(tag);
        return slots_[i];
      }
      if (tags_[slots_[i]] == tag && equal(positions_[slots_[i]], key)) return slots_[i];
    }
  }

  // Of each position.
  const std::vector<std::uint16_t>& tags() const { return tags_; }

 private:
  static constexpr std::uint32_t kEmpty = 0xffffffffu;

  // By bits, so that values that are not numbers equal themselves.
  static std::array<std::uint32_t, 3> bits(Vec3 p) {
    return {std::bit_cast<std::uint32_t>(p.x), std::bit_cast<std::uint32_t>(p.y),
            std::bit_cast<std::uint32_t>(p.z)};
  }
  static bool equal(Vec3 a, Vec3 b) { return bits(a) == bits(b); }
  static std::size_t hash(Vec3 p, std::uint16_t tag) {
    const auto [x, y, z] = bits(p);
    std::uint64_t h = (x | std::uint64_t{y} << 32) * 0x9e3779b97f4a7c15u;
    h = (h ^ h >> 32 ^ (z | std::uint64_t{tag} << 32)) * 0xd6e8feb86659fd93u;
    return h ^ h >> 32;
  }

  std::vector<Vec3>& positions_;
  std::vector<std::uint16_t> tags_;
  std::vector<std::uint32_t> slots_;
};

Status check_stl_count(std::uint64_t count, const SceneLimit& limit) {
  const std::uint64_t most = std::min<std::uint64_t>(limit.most, kMaxObjTriangles);
  if (count <= most) return {};
  return fail(ErrorCode::kResourceExhausted,
              fmt::format("has more than the {} triangles that a scene may have here{}", most,
                          limit.option.empty() ? "" : fmt::format(" ({})", limit.option)));
}

// The attribute bytes of each triangle.
std::vector<std::uint16_t> stl_attributes(std::string_view bytes, std::uint64_t count) {
  std::vector<std::uint16_t> attributes(count);
  const char* at = bytes.data() + kStlHeaderBytes;
  for (std::uint64_t i = 0; i < count; ++i, at += kStlTriangleBytes)
    attributes[i] =
        load_ply_value<std::uint16_t>(at + kStlTriangleBytes - sizeof(std::uint16_t), kStlIsSwapped);
  return attributes;
}

Result<MeshFile> read_binary_stl(std::string_view bytes, const SceneLimit& limit) {
  const std::uint64_t claimed = stl_triangle_count(bytes);
  const std::size_t body = bytes.size() - std::min(bytes.size(), kStlHeaderBytes);
  const std::uint64_t count = std::min<std::uint64_t>(claimed, body / kStlTriangleBytes);
  if (bytes.size() < kStlHeaderBytes || count < (claimed + kMinStlShare - 1) / kMinStlShare)
    return fail(ErrorCode::kInvalidArgument, "is a broken STL file (it ends too early)");
  if (auto fits = check_stl_count(count, limit); !fits) return fail(fits.error());
  MeshFile file;
  if (count < claimed)
    file.warnings.add("incomplete", 0, [&] {
      return fmt::format("ends after {} of its {} triangles: a part of the mesh is missing", count, claimed);
    });
  file.mesh.triangles.reserve(count);
  file.mesh.positions.reserve(count / 2);
  PositionIndex index(file.mesh.positions, 3 * count);
  const std::vector<std::uint16_t> attributes = stl_attributes(bytes, count);
  const auto colors = stl_colors(bytes.substr(0, kStlTextBytes), attributes);
  const char* at = bytes.data() + kStlHeaderBytes;
  for (std::uint64_t i = 0; i < count; ++i, at += kStlTriangleBytes) {
    const auto corner = [&](std::size_t k) {
      const auto value = [&](std::size_t axis) {
        return load_ply_value<float>(at + 12 * (k + 1) + 4 * axis, kStlIsSwapped);
      };
      return index.number({value(0), value(1), value(2)}, colors ? attributes[i] : std::uint16_t{0});
    };
    const std::uint32_t a = corner(0), b = corner(1);
    file.mesh.triangles.push_back({a, b, corner(2)});
  }
  if (colors)
    for (const std::uint16_t tag : index.tags()) file.mesh.colors.push_back(colors->of(tag));
  return file;
}

// Reads "vertex X Y Z" lines; three between "outer loop" and "endloop" are a triangle. Keywords in any case.
class StlTextReader {
 public:
  StlTextReader(std::string_view text, const SceneLimit& limit)
      : text_(text), limit_(limit), index_(file_.mesh.positions, text.size() / kShortestVertex) {}

  Result<MeshFile> read();

 private:
  static constexpr std::size_t kShortestVertex = std::string_view("vertex 0 0 0").size();

  Status statement(std::string_view keyword, std::string_view rest);
  Status add_vertex(std::string_view numbers);
  Status end_loop();
  tl::unexpected<Error> broken(std::string_view what) const {
    return fail(ErrorCode::kInvalidArgument, fmt::format("is a broken STL file (line {}: {})", line_, what));
  }

  std::string_view text_;
  const SceneLimit& limit_;
  MeshFile file_;
  PositionIndex index_;
  std::vector<std::uint32_t> loop_;
  int line_ = 0;
  bool has_solid_ = false, is_complete_ = false;
};

Result<MeshFile> StlTextReader::read() {
  std::string_view rest = text_;
  while (!rest.empty()) {
    std::string_view line = take_line(rest);
    ++line_;
    const std::string_view keyword = take_word(line);
    if (auto done = statement(keyword, line); !done) {
      const bool is_cut_off = rest.empty() && !text_.ends_with('\n') && !text_.ends_with('\r');
      if (!is_cut_off || done.error().code != ErrorCode::kInvalidArgument) return fail(done.error());
    }
  }
  if (!is_complete_)
    file_.warnings.add("incomplete", 0,
                       [] { return "ends without 'endsolid': a part of the mesh may be missing"; });
  return std::move(file_);
}

Status StlTextReader::statement(std::string_view keyword, std::string_view rest) {
  if (equal_ignoring_case(keyword, "vertex")) return add_vertex(rest);
  if (equal_ignoring_case(keyword, "outer")) loop_.clear();
  if (equal_ignoring_case(keyword, "endloop")) return end_loop();
  if (equal_ignoring_case(keyword, "facet")) is_complete_ = false;
  if (equal_ignoring_case(keyword, "endfacet")) is_complete_ = !has_solid_;
  if (equal_ignoring_case(keyword, "endsolid")) is_complete_ = true;
  if (equal_ignoring_case(keyword, "solid")) {
    has_solid_ = true;
    is_complete_ = false;
  }
  return {};
}

Status StlTextReader::add_vertex(std::string_view numbers) {
  std::array<float, 3> p{};
  if (read_numbers(numbers, p).count != 3) return broken("'vertex' needs three numbers");
  if (loop_.size() < 4) loop_.push_back(index_.number({p[0], p[1], p[2]}));
  return {};
}

Status StlTextReader::end_loop() {
  if (loop_.size() != 3) return broken("a loop needs three vertices");
  if (auto fits = check_stl_count(file_.mesh.triangles.size() + 1, limit_); !fits) return fits;
  file_.mesh.triangles.push_back({loop_[0], loop_[1], loop_[2]});
  loop_.clear();
  return {};
}

Result<MeshFile> read_plain_stl(std::string_view bytes, const SceneLimit& limit) {
  if (is_binary_stl(bytes)) return read_binary_stl(bytes, limit);
  std::string converted;
  const std::string_view text = as_utf8(bytes, converted);
  return is_text_stl(text) ? StlTextReader(text, limit).read() : read_binary_stl(bytes, limit);
}

}  // namespace

bool is_stl(std::string_view bytes) {
  std::string converted;
  return is_binary_stl(bytes) || is_text_stl(as_utf8(bytes.substr(0, kStlHeadBytes), converted));
}

Result<MeshFile> read_stl(std::string_view bytes, const std::string& name, const SceneLimit& triangles) {
  auto file = read_plain_stl(bytes, triangles);
  if (!file) return fail(file.error().code, fmt::format("{} {}", in_quotes(name), file.error().message));
  if (file->mesh.triangles.empty())
    return fail(ErrorCode::kInvalidArgument, in_quotes(name) + " has no triangles");
  file->mesh.triangle_materials = {0};
  return file;
}

}  // namespace tessera::core
