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

#include "core/scene/loader/polygon.hpp"
#include "core/scene/loader/text_lines.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

// From 0; -1 for none.
struct FaceCorner {
  std::int32_t position = -1, uv = -1, normal = -1;
};

// Takes a number other than 0 off the front of `rest`. More digits than these refer to nothing, and would
// not fit an int.
bool take_index(std::string_view& rest) {
  constexpr std::size_t kMostDigits = 9;
  if (rest.starts_with('-')) rest.remove_prefix(1);
  const std::size_t digits = std::min(rest.find_first_not_of("0123456789"), rest.size());
  const bool zero = rest.find_first_not_of('0') >= digits;
  rest.remove_prefix(digits);
  return !zero && digits <= kMostDigits;
}

bool take_slash(std::string_view& rest) {
  if (!rest.starts_with('/')) return false;
  rest.remove_prefix(1);
  return true;
}

// v, v/vt, v//vn or v/vt/vn.
bool is_corner(std::string_view word) {
  if (!take_index(word)) return false;
  if (take_slash(word)) {
    if (!word.starts_with('/') && !take_index(word)) return false;
    if (take_slash(word) && !take_index(word)) return false;
  }
  return word.empty();
}

// The second pass: faces, with the material and the smoothing group they are under. Statements are read here
// and faces handed on to tinyobjloader as text, each one checked, on one line and without comments; what it
// makes of a face comes back before it asks for the next.
class FaceReader : private std::streambuf {
 public:
  FaceReader(std::string_view bytes, const std::string& name, ObjText text, const SceneLimit& limit);

  Result<ObjFile> read();

 private:
  // One kind of vertex data: how many there are before the current line, and in the whole file.
  struct Counts {
    std::string_view statement;
    std::int64_t total;
    std::int32_t seen = 0;
  };

  // `index` as written: from 1 for the first, or from -1 for the last so far; 0 for none.
  static bool exists(int index, const Counts& counts) {
    return index < 0 ? index >= -counts.seen : index <= counts.total;
  }
  static std::int32_t resolve(int index, const Counts& counts) {
    return index < 0 ? counts.seen + index : index - 1;
  }

  int_type underflow() override;
  Status statement(std::string_view line);
  Status hand_on(std::string_view line);
  Status face(const tinyobj::index_t* corners, int count);
  Status corner(const tinyobj::index_t& written, int number);
  Status use_material(std::string_view line);
  Status smooth(std::string_view line);
  Status count_triangles(std::size_t more) const;
  tl::unexpected<Error> bad_corner(std::string_view word) const;
  tl::unexpected<Error> missing(int index, const Counts& counts, int corner) const;
  std::string_view text_of_corner(int number) const;
  void add(const std::array<std::uint32_t, 3>& triangle);

  tl::unexpected<Error> mistake(std::string_view what) const {
    return fail(ErrorCode::kInvalidArgument, fmt::format("{}:{}: {}", name_, lines_.number(), what));
  }

  StatementLines lines_;
  const std::string& name_;
  const SceneLimit& limit_;
  ObjFile file_;
  Counts positions_, uvs_, normals_;
  ObjFile::Run run_;
  bool run_is_new_ = true;
  std::map<std::string, std::uint32_t, std::less<>> material_indices_;
  Status status_;  // of the first statement that is wrong
  // Of one face; kept for their memory.
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
  if (stream.bad()) throw std::bad_alloc();  // streams keep exceptions to themselves
  if (!status_) return fail(status_.error());
  return std::move(file_);
}

// The text up to the end of the next face.
FaceReader::int_type FaceReader::underflow() {
  face_text_.clear();
  while (status_ && face_text_.empty() && lines_.next()) status_ = statement(lines_.line());
  if (!status_ || face_text_.empty()) return traits_type::eof();
  setg(face_text_.data(), face_text_.data(), face_text_.data() + face_text_.size());
  return traits_type::to_int_type(face_text_.front());
}

Status FaceReader::statement(std::string_view line) {
  const std::string_view keyword = take_word(line);
  if (is_face(keyword)) return hand_on(line);
  if (keyword == "v") ++positions_.seen;
  if (keyword == "vt") ++uvs_.seen;
  if (keyword == "vn") ++normals_.seen;
  if (keyword == "usemtl") return use_material(line);
  if (keyword == "s") return smooth(line);
  return {};
}

Status FaceReader::hand_on(std::string_view line) {
  line = without_comment(line);
  face_text_ = "f";
  int corners = 0;
  for (auto word = take_word(line); !word.empty(); word = take_word(line), ++corners) {
    if (!is_corner(word)) return bad_corner(word);
    face_text_ += ' ';
    face_text_ += word;
  }
  face_text_ += '\n';
  if (corners < 3) return mistake(fmt::format("a face must have at least 3 corners, got {}", corners));
  return {};
}

Status FaceReader::face(const tinyobj::index_t* corners, int count) {
  face_.clear();
  for (int i = 0; i < count; ++i)
    if (auto ok = corner(corners[i], i); !ok) return ok;
  if (auto ok = count_triangles(face_.size() - 2); !ok) return ok;
  if (face_.size() == 3) {
    add({0, 1, 2});
    return {};
  }
  outline_.clear();
  triangles_.clear();
  for (const FaceCorner& c : face_)
    outline_.push_back(file_.text.positions[static_cast<std::size_t>(c.position)]);
  if (!triangulate(outline_, triangles_))
    return mistake(fmt::format("a face that is not convex may have {} corners at most", kMaxConcaveCorners));
  for (const auto& triangle : triangles_) add(triangle);
  return {};
}

Status FaceReader::count_triangles(std::size_t more) const {
  const std::size_t count = file_.triangle_count() + more;
  if (count > limit_.most)
    return fail(ErrorCode::kResourceExhausted,
                fmt::format("{}:{}: the file has more than the {} triangles that a scene may have here ({})",
                            name_, lines_.number(), limit_.most, limit_.option));
  if (count <= kMaxObjTriangles) return {};
  return mistake(fmt::format("the file has more than {} triangles; cut it into several", kMaxObjTriangles));
}

Status FaceReader::corner(const tinyobj::index_t& written, int number) {
  const int v = written.vertex_index, vt = written.texcoord_index, vn = written.normal_index;
  if (!exists(v, positions_)) return missing(v, positions_, number);
  if (!exists(vt, uvs_)) return missing(vt, uvs_, number);
  if (!exists(vn, normals_)) return missing(vn, normals_, number);
  face_.push_back({resolve(v, positions_), resolve(vt, uvs_), resolve(vn, normals_)});
  return {};
}

tl::unexpected<Error> FaceReader::missing(int index, const Counts& counts, int corner) const {
  if (index < 0) return bad_corner(text_of_corner(corner));
  return mistake(fmt::format("a face refers to '{}' number {}, but the file has only {}; is it complete?",
                             counts.statement, index, counts.total));
}

std::string_view FaceReader::text_of_corner(int number) const {
  std::string_view rest = std::string_view(face_text_).substr(0, face_text_.size() - 1);
  take_word(rest);
  for (int i = 0; i < number; ++i) take_word(rest);
  return take_word(rest);
}

tl::unexpected<Error> FaceReader::bad_corner(std::string_view word) const {
  return mistake(
      fmt::format("a face's corner must be like 7, 7/2, 7//3 or 7/2/3 with numbers that exist, got {} "
                  "after {} v, {} vt and {} vn",
                  in_quotes(word), positions_.seen, uvs_.seen, normals_.seen));
}

void FaceReader::add(const std::array<std::uint32_t, 3>& triangle) {
  std::vector<std::int32_t>& positions = file_.corners.positions;
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
    append(file_.corners.uvs, face_[i].uv);
    append(file_.corners.normals, face_[i].normal);
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

Result<ObjFile> read_obj(std::string_view bytes, const std::string& name, const SceneLimit& triangles) {
  bytes = without_byte_order_mark(bytes);
  auto text = scan_obj(bytes, name);
  if (!text) return fail(text.error());
  if (text->face_count > triangles.most)
    return fail(
        ErrorCode::kResourceExhausted,
        fmt::format("{}: the file has {} faces, more than the {} triangles that a scene may have here ({})",
                    name, text->face_count, triangles.most, triangles.option));
  return FaceReader(bytes, name, std::move(*text), triangles).read();
}

}  // namespace tessera::core
