#include "core/scene/loader/obj_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <iterator>
#include <map>

#include "core/scene/loader/polygon.hpp"
#include "core/scene/loader/text_lines.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

// As written: from 1 for the first, or from -1 for the last so far; 0 for none.
struct WrittenCorner {
  int v = 0, vt = 0, vn = 0;
};
// From 0; -1 for none.
struct Corner {
  std::int32_t position = -1, uv = -1, normal = -1;
};

// Takes a number other than 0 off the front of `rest`.
bool take_index(std::string_view& rest, int& index) {
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), index);
  rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
  return error == std::errc() && index != 0;
}

bool take_slash(std::string_view& rest) {
  if (!rest.starts_with('/')) return false;
  rest.remove_prefix(1);
  return true;
}

// v, v/vt, v//vn or v/vt/vn.
std::optional<WrittenCorner> parse_corner(std::string_view word) {
  WrittenCorner corner;
  if (!take_index(word, corner.v)) return std::nullopt;
  if (take_slash(word)) {
    if (!word.starts_with('/') && !take_index(word, corner.vt)) return std::nullopt;
    if (take_slash(word) && !take_index(word, corner.vn)) return std::nullopt;
  }
  return word.empty() ? std::optional(corner) : std::nullopt;
}

// The second pass: faces, with the material and the smoothing group they are under.
class FaceReader {
 public:
  FaceReader(std::string_view bytes, const std::string& name, ObjText text);

  Result<ObjFile> read();

 private:
  // One kind of vertex data: how many there are before the current line, and in the whole file.
  struct Counts {
    std::string_view statement;
    std::int64_t total;
    std::int32_t seen = 0;
  };

  static bool exists(int index, const Counts& counts) {
    return index < 0 ? index >= -counts.seen : index <= counts.total;
  }
  static std::int32_t resolve(int index, const Counts& counts) {
    return index < 0 ? counts.seen + index : index - 1;
  }

  Status statement(std::string_view line);
  Status face(std::string_view line);
  Status corner(std::string_view word);
  Status use_material(std::string_view line);
  Status smooth(std::string_view line);
  tl::unexpected<Error> bad_corner(std::string_view word) const;
  tl::unexpected<Error> missing(int index, const Counts& counts, std::string_view word) const;
  void add(const std::array<std::uint32_t, 3>& triangle);

  tl::unexpected<Error> mistake(std::string_view what) const {
    return fail(ErrorCode::kInvalidArgument, fmt::format("{}:{}: {}", name_, lines_.number(), what));
  }

  StatementLines lines_;
  const std::string& name_;
  ObjFile file_;
  Counts positions_, uvs_, normals_;
  ObjFile::Run run_;
  bool run_is_new_ = true;
  std::map<std::string, std::uint32_t, std::less<>> material_indices_;
  // Of one face; kept for their memory.
  std::vector<Corner> face_;
  std::vector<Vec3> outline_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
};

FaceReader::FaceReader(std::string_view bytes, const std::string& name, ObjText text)
    : lines_(bytes),
      name_(name),
      positions_{"v", std::ssize(text.positions)},
      uvs_{"vt", std::ssize(text.uvs)},
      normals_{"vn", std::ssize(text.normals)} {
  file_.text = std::move(text);
  file_.corners.positions.reserve(3 * file_.text.face_count);
}

Result<ObjFile> FaceReader::read() {
  while (lines_.next())
    if (auto ok = statement(lines_.line()); !ok) return fail(ok.error());
  return std::move(file_);
}

Status FaceReader::statement(std::string_view line) {
  const std::string_view keyword = take_word(line);
  if (is_face(keyword)) return face(line);
  if (keyword == "v") ++positions_.seen;
  if (keyword == "vt") ++uvs_.seen;
  if (keyword == "vn") ++normals_.seen;
  if (keyword == "usemtl") return use_material(line);
  if (keyword == "s") return smooth(line);
  return {};
}

Status FaceReader::face(std::string_view line) {
  face_.clear();
  line = without_comment(line);
  for (auto word = take_word(line); !word.empty(); word = take_word(line))
    if (auto ok = corner(word); !ok) return ok;
  if (face_.size() < 3)
    return mistake(fmt::format("a face must have at least 3 corners, got {}", face_.size()));
  if (file_.triangle_count() + face_.size() > kMaxObjTriangles)
    return mistake(fmt::format("the file has more than {} triangles; cut it into several", kMaxObjTriangles));
  if (face_.size() == 3) {
    add({0, 1, 2});
    return {};
  }
  outline_.clear();
  triangles_.clear();
  for (const Corner& c : face_)
    outline_.push_back(file_.text.positions[static_cast<std::size_t>(c.position)]);
  if (!triangulate(outline_, triangles_))
    return mistake(fmt::format("a face that is not convex may have {} corners at most", kMaxConcaveCorners));
  for (const auto& triangle : triangles_) add(triangle);
  return {};
}

Status FaceReader::corner(std::string_view word) {
  const auto written = parse_corner(word);
  if (!written) return bad_corner(word);
  if (!exists(written->v, positions_)) return missing(written->v, positions_, word);
  if (!exists(written->vt, uvs_)) return missing(written->vt, uvs_, word);
  if (!exists(written->vn, normals_)) return missing(written->vn, normals_, word);
  face_.push_back(
      {resolve(written->v, positions_), resolve(written->vt, uvs_), resolve(written->vn, normals_)});
  return {};
}

tl::unexpected<Error> FaceReader::missing(int index, const Counts& counts, std::string_view word) const {
  if (index < 0) return bad_corner(word);
  return mistake(fmt::format("a face refers to '{}' number {}, but the file has only {}; is it complete?",
                             counts.statement, index, counts.total));
}

tl::unexpected<Error> FaceReader::bad_corner(std::string_view word) const {
  return mistake(
      fmt::format("a face's corner must be like 7, 7/2, 7//3 or 7/2/3 with numbers that exist, got {} "
                  "after {} v, {} vt and {} vn",
                  in_quotes(word), positions_.seen, uvs_.seen, normals_.seen));
}

void FaceReader::add(const std::array<std::uint32_t, 3>& triangle) {
  auto& [positions, uvs, normals] = file_.corners;
  if (run_is_new_) {
    run_.first_triangle = file_.triangle_count();
    file_.runs.push_back(run_);
    run_is_new_ = false;
  }
  // A list is begun by the first face that needs it.
  const auto append = [&](std::vector<std::int32_t>& list, std::int32_t index) {
    if (list.empty() && index < 0) return;
    if (list.empty()) {
      list.reserve(positions.capacity());
      list.resize(positions.size(), -1);
    }
    list.push_back(index);
  };
  for (const std::uint32_t i : triangle) {
    append(uvs, face_[i].uv);
    append(normals, face_[i].normal);
    positions.push_back(face_[i].position);
  }
}

Status FaceReader::use_material(std::string_view line) {
  const std::string_view material = trimmed(line);
  if (name_without_comment(material).empty()) return mistake("'usemtl' needs a name");
  auto known = material_indices_.find(material);
  if (known == material_indices_.end()) {
    const auto index = static_cast<std::uint32_t>(file_.material_names.size());
    known = material_indices_.emplace(material, index).first;
    file_.material_names.emplace_back(material);
    file_.material_lines.push_back(lines_.number());
  }
  run_is_new_ = run_is_new_ || run_.material != known->second;
  run_.material = known->second;
  return {};
}

// Some programs write more than the group's number; they mean the first.
Status FaceReader::smooth(std::string_view line) {
  line = without_comment(line);
  const std::string_view word = take_word(line);
  std::uint32_t group = word == "on" ? 1 : 0;
  if (word != "on" && word != "off" && word != "null") {
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), group);
    if (error != std::errc() || end != word.data() + word.size())
      return mistake(
          fmt::format("'s' must be the number of a smoothing group or 'off', got {}", in_quotes(word)));
  }
  run_is_new_ = run_is_new_ || run_.smoothing_group != group;
  run_.smoothing_group = group;
  return {};
}

}  // namespace

const ObjFile::Run& ObjFile::run_of(std::size_t triangle) const {
  const auto after = std::upper_bound(runs.begin(), runs.end(), triangle,
                                      [](std::size_t t, const Run& run) { return t < run.first_triangle; });
  return *(after - 1);
}

Result<ObjFile> read_obj(std::string_view bytes, const std::string& name) {
  bytes = without_byte_order_mark(bytes);
  auto text = scan_obj(bytes, name);
  if (!text) return fail(text.error());
  return FaceReader(bytes, name, std::move(*text)).read();
}

}  // namespace tessera::core
