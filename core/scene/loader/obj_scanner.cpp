#include "core/scene/loader/obj_scanner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "core/scene/loader/text_lines.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

// Legal, and of no use here.
constexpr std::array<std::string_view, 14> kIgnored{"g",   "o",          "s",         "l",        "p",
                                                    "vp",  "vw",         "bevel",     "c_interp", "d_interp",
                                                    "lod", "shadow_obj", "trace_obj", "mg"};
constexpr std::array<std::string_view, 6> kFreeForm{"cstype", "curv", "curv2", "surf", "bmat", "deg"};

// One kind of vertex data that faces refer to.
struct Indexed {
  std::string_view statement;
  int count = 0;         // so far
  int largest = 0;       // of the indices
  int largest_line = 0;  // where it is used first
};

class ObjScanner {
 public:
  ObjScanner(std::string_view text, const std::string& name) : rest_(text), name_(name) {}

  Result<ObjText> scan();

 private:
  Status statement(std::string_view line);
  Status vertex(std::string_view line);
  Status normal(std::string_view line);
  Status texture_vertex(std::string_view line);
  Status face(std::string_view line);
  Status corner(std::string_view word);
  Status named(std::string_view keyword, std::string_view line);
  bool index(std::string_view word, Indexed& data);
  Status unknown(std::string_view keyword) const;
  Status check_indices() const;

  tl::unexpected<Error> mistake(std::string_view what, int line) const {
    return fail(ErrorCode::kInvalidArgument, fmt::format("{}:{}: {}", name_, line, what));
  }
  tl::unexpected<Error> mistake(std::string_view what) const { return mistake(what, line_number_); }

  std::string_view rest_;
  const std::string& name_;
  int line_number_ = 0;
  ObjText obj_;
  Indexed positions_{"v"}, uvs_{"vt"}, normals_{"vn"};
};

Result<ObjText> ObjScanner::scan() {
  while (!rest_.empty()) {
    ++line_number_;
    if (auto ok = statement(take_line(rest_)); !ok) return fail(ok.error());
  }
  if (auto ok = check_indices(); !ok) return fail(ok.error());
  if (obj_.first_face_line == 0) return mistake("the file has no faces (no 'f' statement); is it complete?");
  return std::move(obj_);
}

Status ObjScanner::statement(std::string_view line) {
  const std::string_view keyword = take_word(line);
  if (keyword.empty() || keyword.front() == '#') return {};
  if (keyword == "v") return vertex(line);
  if (keyword == "f") return face(line);
  if (keyword == "vt") return texture_vertex(line);
  if (keyword == "vn") return normal(line);
  if (keyword == "usemtl" || keyword == "mtllib") return named(keyword, line);
  if (std::find(kIgnored.begin(), kIgnored.end(), keyword) != kIgnored.end()) return {};
  return unknown(keyword);
}

Status ObjScanner::vertex(std::string_view line) {
  std::array<float, 3> p{};
  // A weight, a colour or both may follow.
  if (read_numbers(line, p, 7) < 3)
    return mistake(fmt::format("a vertex must be 3 finite numbers, got {}", in_quotes(line)));
  obj_.positions.push_back({p[0], p[1], p[2]});
  ++positions_.count;
  return {};
}

Status ObjScanner::normal(std::string_view line) {
  std::array<float, 3> n{};
  if (read_numbers(line, n, 3) != 3)
    return mistake(fmt::format("a normal must be 3 finite numbers, got {}", in_quotes(line)));
  obj_.normals.push_back({n[0], n[1], n[2]});
  ++normals_.count;
  return {};
}

Status ObjScanner::texture_vertex(std::string_view line) {
  std::array<float, 2> uv{};
  if (read_numbers(line, uv, 3) < 1)
    return mistake(
        fmt::format("a texture coordinate must be 1 to 3 finite numbers, got {}", in_quotes(line)));
  obj_.uvs.push_back({uv[0], uv[1]});
  ++uvs_.count;
  return {};
}

Status ObjScanner::face(std::string_view line) {
  int corners = 0;
  for (auto word = take_word(line); !word.empty(); word = take_word(line), ++corners)
    if (auto ok = corner(word); !ok) return ok;
  if (corners < 3) return mistake(fmt::format("a face must have at least 3 corners, got {}", corners));
  if (obj_.first_face_line == 0) obj_.first_face_line = line_number_;
  return {};
}

// v, v/vt, v//vn or v/vt/vn.
Status ObjScanner::corner(std::string_view word) {
  auto take_part = [rest = word, more = true]() mutable -> std::optional<std::string_view> {
    if (!more) return std::nullopt;
    const std::size_t slash = rest.find('/');
    const std::string_view part = rest.substr(0, slash);
    more = slash != std::string_view::npos;
    rest.remove_prefix(more ? slash + 1 : rest.size());
    return part;
  };
  const auto v = take_part(), vt = take_part(), vn = take_part(), more = take_part();
  const bool has_uv = vt && !(vt->empty() && vn);
  if (more || !index(*v, positions_) || (has_uv && !index(*vt, uvs_)) || (vn && !index(*vn, normals_)))
    return mistake(
        fmt::format("a face's corner must be like 7, 7/2, 7//3 or 7/2/3 with numbers that exist, got {} "
                    "after {} v, {} vt and {} vn",
                    in_quotes(word), positions_.count, uvs_.count, normals_.count));
  return {};
}

// Whether `word` is a number that may refer to `data`: forwards is found out at the end of the file.
bool ObjScanner::index(std::string_view word, Indexed& data) {
  const auto number = parse_int(word);
  if (!number || *number == 0 || *number < -data.count) return false;
  if (*number > data.largest) {
    data.largest = *number;
    data.largest_line = line_number_;
  }
  return true;
}

Status ObjScanner::named(std::string_view keyword, std::string_view line) {
  const std::string_view argument = trimmed(line);
  if (argument.empty()) return mistake(fmt::format("'{}' needs a name", keyword));
  if (keyword == "mtllib") {
    obj_.libraries.push_back({std::string(argument), line_number_});
  } else {
    obj_.usemtl_lines.push_back(line_number_);
  }
  return {};
}

Status ObjScanner::unknown(std::string_view keyword) const {
  if (std::find(kFreeForm.begin(), kFreeForm.end(), keyword) != kFreeForm.end())
    return mistake("free-form curves and surfaces are not supported; export the mesh as polygons");
  if (keyword.ends_with('\\')) return mistake("lines continued with '\\' are not supported");
  return mistake(fmt::format("{} is not a statement of OBJ files", in_quotes(keyword)));
}

Status ObjScanner::check_indices() const {
  for (const Indexed* data : {&positions_, &uvs_, &normals_})
    if (data->largest > data->count)
      return mistake(fmt::format("a face refers to '{}' number {}, but the file has only {}; is it complete?",
                                 data->statement, data->largest, data->count),
                     data->largest_line);
  return {};
}

}  // namespace

Result<ObjText> scan_obj(std::string_view text, const std::string& name) {
  return ObjScanner(text, name).scan();
}

}  // namespace tessera::core
