// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/obj_scanner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <system_error>

#include "core/image/srgb.hpp"
#include "core/scene/loader/text_lines.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

// Valid statements without effect, and "usemtl" and "s", which the second pass reads.
constexpr std::array<std::string_view, 16> kIgnored{
    "usemtl", "s",   "g",        "o",        "l",  "p",          "vp",        "vw",
    "bevel",  "lod", "c_interp", "d_interp", "mg", "shadow_obj", "trace_obj", "mb"};
constexpr std::array<std::string_view, 20> kFreeForm{
    "cstype", "curv", "curv2", "surf", "bmat", "deg", "step", "parm", "trim", "hole",
    "scrv",   "sp",   "con",   "end",  "bsp",  "bzp", "cdc",  "cdp",  "res",  "ctech"};

constexpr std::string_view kFreeFormAdvice =
    "free-form curves and surfaces are not supported; export the mesh as polygons";

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr Rgb kNoColor = Rgb::gray(-1);

// Larger values mean that the file's colours range from 0 to 255. Rounding may leave a colour from 0 to 1
// slightly above 1.
constexpr float kLargestUnitColor = 1.01f;

constexpr std::size_t kMrgbDigits = 8;

// Of two hexadecimal digits each for a mask, which has no effect, red, green and blue.
std::optional<Rgb> mrgb_color(std::string_view digits) {
  std::uint32_t code = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), code, 16);
  if (digits.size() != kMrgbDigits || error != std::errc() || end != digits.data() + digits.size())
    return std::nullopt;
  const auto linear = [code](int shift) { return srgb_decode((code >> shift & 0xff) / 255.0); };
  return Rgb{linear(16), linear(8), linear(0)};
}

class ObjScanner {
 public:
  ObjScanner(std::string_view text, const std::string& name, const WarningLimits& warnings)
      : lines_(text), name_(name) {
    obj_.warnings = FileWarnings(warnings);
  }

  Result<ObjText> scan();

 private:
  void statement(std::string_view line);
  void vertex(std::string_view line);
  void color(std::string_view line, const Numbers& numbers, std::span<const float> values);
  void polypaint(std::string_view line);
  void flush_polypaint();
  void normal(std::string_view line);
  void texture_vertex(std::string_view line);
  void library(std::string_view line);
  void unknown(std::string_view keyword);
  void count_face();
  void settle_alpha();
  void settle_colors();
  Error no_faces() const;

  template <typename Text>
  void warn(std::string_view kind, const Text& text) {
    obj_.warnings.add(kind, lines_.number(), text);
  }

  StatementLines lines_;
  const std::string& name_;
  ObjText obj_;
  // Linear colours of "#MRGB" lines: those since the last vertex, and one for each position or fewer. They
  // replace others.
  std::vector<Rgb> polypaint_block_, polypaint_;
  std::vector<float> fourths_;  // of vertices with colours and seven numbers: the fourth; NaN for others
  bool has_free_form_ = false;
  std::string first_unknown_;  // the first unknown statement
};

Result<ObjText> ObjScanner::scan() {
  while (lines_.next()) statement(lines_.line());
  if (obj_.face_count == 0) return fail(no_faces());
  flush_polypaint();
  settle_alpha();
  settle_colors();
  return std::move(obj_);
}

Error ObjScanner::no_faces() const {
  std::string why = "the file has no faces (no 'f' statement); is it complete?";
  if (!first_unknown_.empty())
    why = fmt::format(
        "the file has no faces (no 'f' statement), and {} is not a statement of OBJ files; is "
        "it one?",
        in_quotes(first_unknown_));
  if (has_free_form_) why = fmt::format("the file has no faces (no 'f' statement): {}", kFreeFormAdvice);
  return {ErrorCode::kInvalidArgument, fmt::format("{}: {}", name_, why)};
}

void ObjScanner::statement(std::string_view line) {
  const std::string_view keyword = take_word(line);
  if (keyword == "#MRGB") return polypaint(line);
  if (keyword.empty() || keyword.front() == '#') return;
  if (keyword == "v") return vertex(line);
  if (is_face(keyword)) return count_face();
  if (keyword == "vt") return texture_vertex(line);
  if (keyword == "vn") return normal(line);
  if (keyword == "mtllib") return library(line);
  if (std::find(kIgnored.begin(), kIgnored.end(), keyword) == kIgnored.end()) unknown(keyword);
}

// A weight, a colour or both may follow the position.
void ObjScanner::vertex(std::string_view line) {
  flush_polypaint();
  std::array<float, 7> values{};
  const Numbers numbers = read_numbers(line, values);
  if (numbers.count < 3) {
    warn("vertex", [&] {
      return fmt::format("a vertex must be 3 finite numbers, got {}; faces that use it are left out",
                         in_quotes(line));
    });
    obj_.broken_vertices.push_back({static_cast<std::int32_t>(obj_.positions.size()), lines_.number()});
    obj_.positions.push_back({kNan, kNan, kNan});
  } else {
    obj_.positions.push_back({values[0], values[1], values[2]});
  }
  color(line, numbers, values);
}

void ObjScanner::color(std::string_view line, const Numbers& numbers, std::span<const float> values) {
  Rgb color = kNoColor;
  const bool has_color = numbers.words == 6 || numbers.words == 7;
  const auto first = static_cast<std::size_t>(numbers.words - 3);
  if (has_color && numbers.all_are_numbers) {
    color = {values[first], values[first + 1], values[first + 2]};
  } else if (has_color || numbers.words > 7) {
    warn("colour", [&] {
      return fmt::format(
          "what follows the position of a vertex must be 3 finite numbers, got {}; the vertex "
          "has no colour",
          in_quotes(line));
    });
  }
  if (obj_.colors.empty() && color == kNoColor) return;
  obj_.colors.resize(obj_.positions.size() - 1, kNoColor);
  obj_.colors.push_back(color);
  if (numbers.words < 7 || color == kNoColor) return;
  fourths_.resize(obj_.colors.size() - 1, kNan);
  fourths_.push_back(values[3]);
}

// ZBrush writes the colours of the vertices before them as comments.
void ObjScanner::polypaint(std::string_view line) {
  for (auto word = take_word(line); !word.empty(); word = take_word(line)) {
    for (; !word.empty(); word.remove_prefix(std::min(kMrgbDigits, word.size()))) {
      const std::string_view digits = word.substr(0, kMrgbDigits);
      const auto color = mrgb_color(digits);
      polypaint_block_.push_back(color.value_or(kNoColor));
      if (color) continue;
      warn("#MRGB", [&] {
        return fmt::format(
            "a colour of '#MRGB' must be 8 hexadecimal digits, got {}; the vertex has no colour",
            in_quotes(digits));
      });
    }
  }
  if (polypaint_block_.size() <= obj_.positions.size()) return;
  polypaint_block_.resize(obj_.positions.size());
  warn("colours of #MRGB", [&] {
    return fmt::format(
        "'#MRGB' has more colours than the {} vertices before it; the further ones are ignored",
        obj_.positions.size());
  });
}

// A block with fewer colours than vertices is that of the last ones, as in Blender.
void ObjScanner::flush_polypaint() {
  if (polypaint_block_.empty()) return;
  polypaint_.resize(obj_.positions.size() - polypaint_block_.size(), kNoColor);
  polypaint_.insert(polypaint_.end(), polypaint_block_.begin(), polypaint_block_.end());
  polypaint_block_.clear();
}

void ObjScanner::normal(std::string_view line) {
  std::array<float, 3> n{};
  const Numbers numbers = read_numbers(line, n);
  if (numbers.count < 3) {
    n = {};
    warn("normal", [&] {
      return fmt::format("a normal must be 3 finite numbers, got {}; it counts as none", in_quotes(line));
    });
  }
  obj_.normals.push_back({n[0], n[1], n[2]});
}

void ObjScanner::texture_vertex(std::string_view line) {
  std::array<float, 2> uv{};
  const Numbers numbers = read_numbers(line, uv);
  if (numbers.count < std::clamp(numbers.words, 1, 2)) {
    uv = {};
    warn("texture coordinate", [&] {
      return fmt::format("a texture coordinate must be 1 to 3 finite numbers, got {}; it counts as 0 0",
                         in_quotes(line));
    });
  }
  obj_.uvs.push_back({uv[0], uv[1]});
}

void ObjScanner::library(std::string_view line) {
  const std::string_view argument = trimmed(line);
  if (name_without_comment(argument).empty()) return warn("mtllib", [] { return "'mtllib' names no file"; });
  obj_.libraries.push_back({std::string(argument), lines_.number()});
}

void ObjScanner::unknown(std::string_view keyword) {
  if (std::find(kFreeForm.begin(), kFreeForm.end(), keyword) != kFreeForm.end()) {
    has_free_form_ = true;
    return warn("free form", [] { return kFreeFormAdvice; });
  }
  if (keyword == "call")
    return warn("call", [] { return "'call' reads another file, which is not supported; it is ignored"; });
  if (keyword == "usemap" || keyword == "maplib")
    return warn(keyword, [&] {
      return fmt::format("{} names images, which is not supported; name them in an MTL file, as 'map_Kd'",
                         in_quotes(keyword));
    });
  if (keyword == "csh")
    return warn("csh", [] { return "'csh' runs a command, which a scene must not; it is ignored"; });
  if (first_unknown_.empty()) first_unknown_ = keyword;
  warn(fmt::format("statement {}", keyword), [&] {
    return fmt::format("{} is not a statement of OBJ files; the line is ignored", in_quotes(keyword));
  });
}

void ObjScanner::count_face() {
  if (obj_.face_count++ == 0) obj_.first_face_line = lines_.number();
}

// Of seven numbers the fourth is a weight, or else the last one is an opacity: if that is 1 in all vertices,
// and the fourth is not.
void ObjScanner::settle_alpha() {
  bool has_alpha = false;
  for (std::size_t i = 0; i < fourths_.size(); ++i) {
    if (std::isnan(fourths_[i])) continue;
    if (obj_.colors[i].b != 1) return;
    has_alpha = has_alpha || fourths_[i] != 1;
  }
  for (std::size_t i = 0; has_alpha && i < fourths_.size(); ++i)
    if (!std::isnan(fourths_[i])) obj_.colors[i] = {fourths_[i], obj_.colors[i].r, obj_.colors[i].g};
}

// Colours are sRGB-encoded, from 0 to 1 or from 0 to 255.
void ObjScanner::settle_colors() {
  float largest = 0;
  for (const Rgb color : obj_.colors) largest = std::max(largest, max_component(color));
  const double scale = largest > kLargestUnitColor ? 1.0 / 255 : 1.0;
  const auto linear = [&](float encoded) {
    return srgb_decode(std::clamp(static_cast<double>(encoded) * scale, 0.0, 1.0));
  };
  for (Rgb& color : obj_.colors)
    color = color == kNoColor ? Rgb::gray(1) : Rgb{linear(color.r), linear(color.g), linear(color.b)};
  if (!polypaint_.empty()) obj_.colors.resize(obj_.positions.size(), Rgb::gray(1));
  for (std::size_t i = 0; i < polypaint_.size(); ++i)
    if (polypaint_[i] != kNoColor) obj_.colors[i] = polypaint_[i];
  const bool all_white =
      std::all_of(obj_.colors.begin(), obj_.colors.end(), [](Rgb color) { return color == Rgb::gray(1); });
  if (all_white) obj_.colors.clear();
}

}  // namespace

bool is_face(std::string_view keyword) {
  return keyword == "f" || keyword == "fo";
}

Result<ObjText> scan_obj(std::string_view text, const std::string& name, const WarningLimits& warnings) {
  return ObjScanner(text, name, warnings).scan();
}

}  // namespace tessera::core
