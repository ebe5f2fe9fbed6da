// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/obj_reader.hpp"

#include <fmt/format.h>
#include <tiny_obj_loader.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <istream>
#include <iterator>
#include <map>
#include <new>
#include <streambuf>

#include "core/scene/loader/obj_corner.hpp"
#include "core/scene/loader/polygon.hpp"
#include "core/scene/loader/text_lines.hpp"
#include "core/scene/loader/vertex_normals.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

// Indices from 0; -1 for none.
struct FaceCorner {
  std::int32_t position = -1, uv = -1, normal = -1;
};

// The second pass: reads faces, with the current material and smoothing group. This class parses
// statements, and passes each valid face to tinyobjloader as text, on one line and without comments. The
// result of a face returns before the next is requested. Unusable faces are left out.
class FaceReader : private std::streambuf {
 public:
  FaceReader(std::string_view bytes, const std::string& name, ObjText text, const SceneLimit& limit);

  Result<ObjFile> read();

 private:
  // For one kind of vertex data: the number before the current line, and in the whole file.
  struct Counts {
    std::string_view statement;
    std::int64_t total;
    std::int32_t seen = 0;
  };

  // `index` as written: from 1 for the first, or from -1 for the latest; 0 for none.
  static bool exists(int index, const Counts& counts) {
    return index < 0 ? index >= -counts.seen : index <= counts.total;
  }
  static std::int32_t resolve(int index, const Counts& counts) {
    return index < 0 ? counts.seen + index : index - 1;
  }

  int_type underflow() override;
  void statement(std::string_view line);
  void pass_on(std::string_view line);
  Status face(const tinyobj::index_t* corners, int count);
  bool add_corner(const tinyobj::index_t& written);
  std::int32_t optional_index(int index, const Counts& counts);
  void use_material(std::string_view line);
  void smooth(std::string_view line);
  Status count_triangles(std::size_t more) const;
  Status check_enough_is_left() const;
  // Whether a triangle of the current face has one.
  bool has_area() const;
  std::string missing(int index, const Counts& counts) const;
  int line_of_broken(std::int32_t position) const;
  void add(const std::array<std::uint32_t, 3>& triangle);

  template <typename Text>
  void warn(std::string_view kind, const Text& text) {
    file_.text.warnings.add(kind, lines_.number(), text);
  }
  // `why()` describes what is wrong with the current face.
  template <typename Why>
  void leave_out(std::string_view kind, const Why& why);

  StatementLines lines_;
  const std::string& name_;
  const SceneLimit& limit_;
  ObjFile file_;
  Counts positions_, uvs_, normals_;
  ObjFile::Run run_;
  bool run_is_new_ = true;
  std::map<std::string, std::uint32_t, std::less<>> material_indices_;
  Status status_;               // set if a limit is exceeded
  std::size_t left_out_ = 0;    // faces
  std::string first_left_out_;  // location and reason
  // Buffers for one face; kept to reuse their memory.
  std::string face_text_;
  std::vector<FaceCorner> face_;
  std::vector<Vec3> outline_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
};

FaceReader::FaceReader(std::string_view bytes, const std::string& name, ObjText text, const SceneLimit& limit)
    : lines_(bytes),
      name_(name),
      limit_(limit),
      positions_{"v", std::ssize(text.positions)},
      uvs_{"vt", std::ssize(text.uvs)},
      normals_{"vn", std::ssize(text.normals)} {
  file_.text = std::move(text);
  file_.corners.positions.reserve(3 * file_.text.face_count);
}

Result<ObjFile> FaceReader::read() {
  tinyobj::callback_t callbacks;
  callbacks.index_cb = [](void* self, tinyobj::index_t* corners, int count) {
    FaceReader& reader = *static_cast<FaceReader*>(self);
    reader.status_ = reader.face(corners, count);
  };
  std::istream stream(this);
  tinyobj::LoadObjWithCallback(stream, callbacks, this);
  if (stream.bad()) throw std::bad_alloc();  // streams swallow exceptions
  if (!status_) return fail(status_.error());
  if (auto enough = check_enough_is_left(); !enough) return fail(enough.error());
  return std::move(file_);
}

// Supplies the text up to the end of the next face.
FaceReader::int_type FaceReader::underflow() {
  face_text_.clear();
  while (status_ && face_text_.empty() && lines_.next()) statement(lines_.line());
  if (!status_ || face_text_.empty()) return traits_type::eof();
  setg(face_text_.data(), face_text_.data(), face_text_.data() + face_text_.size());
  return traits_type::to_int_type(face_text_.front());
}

void FaceReader::statement(std::string_view line) {
  const std::string_view keyword = take_word(line);
  if (is_face(keyword)) return pass_on(line);
  if (keyword == "v") ++positions_.seen;
  if (keyword == "vt") ++uvs_.seen;
  if (keyword == "vn") ++normals_.seen;
  if (keyword == "usemtl") return use_material(line);
  if (keyword == "s") return smooth(line);
}

template <typename Why>
void FaceReader::leave_out(std::string_view kind, const Why& why) {
  if (left_out_++ == 0) first_left_out_ = fmt::format("line {}: {}", lines_.number(), why());
  warn(kind, [&] { return why() + "; the face is left out"; });
}

void FaceReader::pass_on(std::string_view line) {
  line = without_comment(line);
  face_text_ = "f";
  int corners = 0;
  for (auto word = take_word(line); !word.empty(); word = take_word(line), ++corners) {
    face_text_ += ' ';
    if (append_corner(word, face_text_)) continue;
    face_text_.clear();
    return leave_out("corner", [&] {
      return fmt::format("a face's corner must be like 7, 7/2, 7//3 or 7/2/3, got {}", in_quotes(word));
    });
  }
  face_text_ += '\n';
  if (corners >= 3) return;
  face_text_.clear();
  leave_out("corners", [&] { return fmt::format("a face must have at least 3 corners, got {}", corners); });
}

Status FaceReader::face(const tinyobj::index_t* corners, int count) {
  face_.clear();
  for (int i = 0; i < count; ++i)
    if (!add_corner(corners[i])) return {};
  if (auto ok = count_triangles(face_.size() - 2); !ok) return ok;
  outline_.clear();
  triangles_.clear();
  for (const FaceCorner& c : face_)
    outline_.push_back(file_.text.positions[static_cast<std::size_t>(c.position)]);
  if (triangulate(outline_, triangles_)) {
    if (!has_area()) warn("flat", [] { return "a face without an area is left out"; });
    for (const auto& triangle : triangles_) add(triangle);
  } else {
    leave_out("concave", [this] {
      return fmt::format("a face of {} corners has too many notches; split it", face_.size());
    });
  }
  return {};
}

bool FaceReader::has_area() const {
  return std::ranges::any_of(triangles_, [&](const std::array<std::uint32_t, 3>& t) {
    return area_normal(outline_[t[0]], outline_[t[1]], outline_[t[2]]) != AreaNormal{};
  });
}

Status FaceReader::count_triangles(std::size_t more) const {
  const std::size_t count = file_.triangle_count() + more;
  const auto place = [&] { return fmt::format("{}:{}", name_, lines_.number()); };
  if (count > limit_.most)
    return fail(ErrorCode::kResourceExhausted,
                fmt::format("{}: the file has more than the {} triangles that a scene may have here ({})",
                            place(), limit_.most, limit_.option));
  if (count <= kMaxObjTriangles) return {};
  return mistake(fmt::format("{}: the file has more than {} triangles; split it into several", place(),
                             kMaxObjTriangles));
}

// Returns false if the face is left out.
bool FaceReader::add_corner(const tinyobj::index_t& written) {
  const int v = written.vertex_index;
  if (!exists(v, positions_)) {
    leave_out("missing v", [&] { return missing(v, positions_); });
    return false;
  }
  const std::int32_t position = resolve(v, positions_);
  if (!is_finite(file_.text.positions[static_cast<std::size_t>(position)])) {
    leave_out("broken v", [&] {
      return fmt::format("a face refers to 'v' number {} in line {}, which is not 3 finite numbers",
                         position + 1, line_of_broken(position));
    });
    return false;
  }
  face_.push_back({position, optional_index(written.texcoord_index, uvs_),
                   optional_index(written.normal_index, normals_)});
  return true;
}

// Returns -1 for a texture coordinate or a normal that does not exist.
std::int32_t FaceReader::optional_index(int index, const Counts& counts) {
  if (exists(index, counts)) return resolve(index, counts);
  warn(counts.statement, [&] { return missing(index, counts) + "; the corner has none"; });
  return -1;
}

std::string FaceReader::missing(int index, const Counts& counts) const {
  if (index < 0)
    return fmt::format("a face refers to '{}' number {}, but only {} come before it", counts.statement, index,
                       counts.seen);
  return fmt::format("a face refers to '{}' number {}, but the file has only {}", counts.statement, index,
                     counts.total);
}

int FaceReader::line_of_broken(std::int32_t position) const {
  return std::ranges::lower_bound(file_.text.broken_vertices, position, {}, &ObjText::BrokenVertex::position)
      ->line;
}

// Rejects a file with too few usable faces, instead of showing a few triangles.
Status FaceReader::check_enough_is_left() const {
  constexpr std::size_t kMinShare = 10;  // at least one face in this many must be usable
  const std::size_t all = file_.text.face_count;
  if (file_.triangle_count() > 0 && (all - left_out_) * kMinShare >= all) return {};
  return mistake(fmt::format("{}: {} of {} faces cannot be used; is the file complete? The first: {}", name_,
                             left_out_, all, first_left_out_));
}

void FaceReader::add(const std::array<std::uint32_t, 3>& triangle) {
  std::vector<std::int32_t>& positions = file_.corners.positions;
  if (run_is_new_) {
    run_.first_triangle = file_.triangle_count();
    file_.runs.push_back(run_);
    run_is_new_ = false;
  }
  // A list is created by the first face that needs it.
  const auto append = [&](std::vector<std::int32_t>& list, std::int32_t index) {
    if (list.empty() && index < 0) return;
    if (list.empty()) {
      list.reserve(positions.capacity());
      list.resize(positions.size(), -1);
    }
    list.push_back(index);
  };
  for (const std::uint32_t i : triangle) {
    append(file_.corners.uvs, face_[i].uv);
    append(file_.corners.normals, face_[i].normal);
    positions.push_back(face_[i].position);
  }
}

void FaceReader::use_material(std::string_view line) {
  const std::string_view name = trimmed(line);
  std::uint32_t material = kNoMaterialName;
  if (name_without_comment(name).empty()) {
    warn("usemtl", [] { return "'usemtl' names no material"; });
  } else {
    const auto next = static_cast<std::uint32_t>(file_.material_names.size());
    const auto known = material_indices_.find(name);
    material = known == material_indices_.end() ? next : known->second;
    if (material == next) {
      material_indices_.emplace(name, next);
      file_.material_names.emplace_back(name);
      file_.material_lines.push_back(lines_.number());
    }
  }
  run_is_new_ = run_is_new_ || run_.material != material;
  run_.material = material;
}

// Some programs write more than the group's number; the first number counts.
void FaceReader::smooth(std::string_view line) {
  line = without_comment(line);
  const std::string_view word = take_word(line);
  std::uint32_t group = word == "on" ? 1 : 0;
  if (word != "on" && word != "off" && word != "null") {
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), group);
    if (error != std::errc() || end != word.data() + word.size())
      return warn("s", [&] {
        return fmt::format(
            "'s' must be the number of a smoothing group or 'off', got {}; the line is ignored",
            in_quotes(word));
      });
  }
  run_is_new_ = run_is_new_ || run_.smoothing_group != group;
  run_.smoothing_group = group;
}

}  // namespace

const ObjFile::Run& ObjFile::run_of(std::size_t triangle) const {
  const auto after = std::upper_bound(runs.begin(), runs.end(), triangle,
                                      [](std::size_t t, const Run& run) { return t < run.first_triangle; });
  return *(after - 1);
}

Result<ObjFile> read_obj(std::string_view bytes, const std::string& name, const SceneLimit& triangles,
                         const WarningLimits& warnings) {
  std::string converted;
  bytes = as_utf8(bytes, converted);
  auto text = scan_obj(bytes, name, warnings);
  if (!text) return fail(text.error());
  if (text->face_count > triangles.most)
    return fail(
        ErrorCode::kResourceExhausted,
        fmt::format("{}: the file has {} faces, more than the {} triangles that a scene may have here ({})",
                    name, text->face_count, triangles.most, triangles.option));
  return FaceReader(bytes, name, std::move(*text), triangles).read();
}

}  // namespace tessera::core
