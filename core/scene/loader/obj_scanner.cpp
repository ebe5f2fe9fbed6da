#include "core/scene/loader/obj_scanner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/scene/loader/text_lines.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

// Legal, and of no use here; but "usemtl" and "s", which the second pass reads.
constexpr std::array<std::string_view, 18> kIgnored{
    "usemtl", "s",        "g",        "o",  "l",          "p",         "vp", "vw",     "bevel",
    "lod",    "c_interp", "d_interp", "mg", "shadow_obj", "trace_obj", "mb", "usemap", "maplib"};
constexpr std::array<std::string_view, 20> kFreeForm{
    "cstype", "curv", "curv2", "surf", "bmat", "deg", "step", "parm", "trim", "hole",
    "scrv",   "sp",   "con",   "end",  "bsp",  "bzp", "cdc",  "cdp",  "res",  "ctech"};

class ObjScanner {
 public:
  ObjScanner(std::string_view text, const std::string& name) : lines_(text), name_(name) {}

  Result<ObjText> scan();

 private:
  Status statement(std::string_view line);
  Status vertex(std::string_view line);
  Status normal(std::string_view line);
  Status texture_vertex(std::string_view line);
  Status library(std::string_view line);
  Status unknown(std::string_view keyword) const;
  void count_face();

  tl::unexpected<Error> mistake(std::string_view what) const {
    return fail(ErrorCode::kInvalidArgument, fmt::format("{}:{}: {}", name_, lines_.number(), what));
  }

  StatementLines lines_;
  const std::string& name_;
  ObjText obj_;
};

Result<ObjText> ObjScanner::scan() {
  while (lines_.next())
    if (auto ok = statement(lines_.line()); !ok) return fail(ok.error());
  if (obj_.face_count == 0) return mistake("the file has no faces (no 'f' statement); is it complete?");
  return std::move(obj_);
}

Status ObjScanner::statement(std::string_view line) {
  const std::string_view keyword = take_word(line);
  if (keyword.empty() || keyword.front() == '#') return {};
  if (keyword == "v") return vertex(line);
  if (is_face(keyword)) {
    count_face();
    return {};
  }
  if (keyword == "vt") return texture_vertex(line);
  if (keyword == "vn") return normal(line);
  if (keyword == "mtllib") return library(line);
  if (std::find(kIgnored.begin(), kIgnored.end(), keyword) != kIgnored.end()) return {};
  return unknown(keyword);
}

Status ObjScanner::vertex(std::string_view line) {
  std::array<float, 3> p{};
  // A weight, a colour or both may follow.
  if (read_numbers(line, p, 7) < 3)
    return mistake(fmt::format("a vertex must be 3 finite numbers, got {}", in_quotes(line)));
  obj_.positions.push_back({p[0], p[1], p[2]});
  return {};
}

Status ObjScanner::normal(std::string_view line) {
  std::array<float, 3> n{};
  if (read_numbers(line, n, 3) != 3)
    return mistake(fmt::format("a normal must be 3 finite numbers, got {}", in_quotes(line)));
  obj_.normals.push_back({n[0], n[1], n[2]});
  return {};
}

Status ObjScanner::texture_vertex(std::string_view line) {
  std::array<float, 2> uv{};
  if (read_numbers(line, uv, 3) < 1)
    return mistake(
        fmt::format("a texture coordinate must be 1 to 3 finite numbers, got {}", in_quotes(line)));
  obj_.uvs.push_back({uv[0], uv[1]});
  return {};
}

Status ObjScanner::library(std::string_view line) {
  const std::string_view argument = trimmed(line);
  if (name_without_comment(argument).empty()) return mistake("'mtllib' needs a name");
  auto& library = obj_.libraries.emplace_back(ObjText::Library{std::string(argument), lines_.number()});
  std::replace(library.name.begin(), library.name.end(), '\\', '/');
  return {};
}

Status ObjScanner::unknown(std::string_view keyword) const {
  if (std::find(kFreeForm.begin(), kFreeForm.end(), keyword) != kFreeForm.end())
    return mistake("free-form curves and surfaces are not supported; export the mesh as polygons");
  if (keyword == "call")
    return mistake("'call' reads another file, which is not supported; put its statements here");
  if (keyword == "csh") return mistake("'csh' runs a command, which a scene must not; take the line out");
  return mistake(fmt::format("{} is not a statement of OBJ files", in_quotes(keyword)));
}

void ObjScanner::count_face() {
  if (obj_.face_count++ == 0) obj_.first_face_line = lines_.number();
}

}  // namespace

bool is_face(std::string_view keyword) {
  return keyword == "f" || keyword == "fo";
}

Result<ObjText> scan_obj(std::string_view text, const std::string& name) {
  return ObjScanner(text, name).scan();
}

}  // namespace tessera::core
