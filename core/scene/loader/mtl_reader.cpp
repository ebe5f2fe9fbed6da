#include "core/scene/loader/mtl_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/scene/loader/mtl_map.hpp"
#include "core/scene/loader/text_lines.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

constexpr float kAbsent = -1;

// The statements under one "newmtl" that count here; what is absent has the value it has here.
struct Statements {
  std::string name;
  Rgb kd, ks, tf, ke;
  float dissolve = kAbsent, transparency = 0, ior = 1, illum = 0, exponent = 0;
  MtlMap albedo_map;
  int albedo_line = 0;
};

constexpr float kLargest = 1e30f;  // of what may be greater than 1
struct ColorRule {
  std::string_view keyword;
  float max;
  Rgb Statements::*color;
};
constexpr std::array kColors{ColorRule{"Kd", 1, &Statements::kd}, ColorRule{"Ks", kLargest, &Statements::ks},
                             ColorRule{"Tf", 1, &Statements::tf}, ColorRule{"Kt", 1, &Statements::tf},
                             ColorRule{"Ke", kLargest, &Statements::ke}};
struct NumberRule {
  std::string_view keyword;
  float min, max;
  float Statements::*number;
};
// Some programs write a negative Ns for a surface without highlights.
constexpr std::array kNumbers{
    NumberRule{"d", 0, 1, &Statements::dissolve}, NumberRule{"Tr", 0, 1, &Statements::transparency},
    NumberRule{"Ni", 0, 10, &Statements::ior}, NumberRule{"Ns", -kLargest, kLargest, &Statements::exponent},
    NumberRule{"illum", 0, 10, &Statements::illum}};

template <typename Rules>
const auto* find_rule(const Rules& rules, std::string_view keyword) {
  const auto* found =
      std::find_if(rules.begin(), rules.end(), [&](const auto& rule) { return rule.keyword == keyword; });
  return found == rules.end() ? nullptr : found;
}

// Ks is used for highlights, too, which may be brighter than a mirror can be.
Rgb at_most_one(Rgb c) {
  return {std::min(c.r, 1.0f), std::min(c.g, 1.0f), std::min(c.b, 1.0f)};
}

// Some programs write a "Tr" that contradicts "d"; it is "d" that others read.
bool is_transparent(const Statements& m) {
  return m.dissolve == kAbsent ? m.transparency > 0 : m.dissolve < 1;
}

// Dimmed so that no channel of the two adds up to more than 1.
Rgb highlight_beside(Rgb diffuse, Rgb highlight) {
  float factor = 1;
  for (const auto channel : {&Rgb::r, &Rgb::g, &Rgb::b})
    if (diffuse.*channel + highlight.*channel > 1)
      factor = std::min(factor, (1 - diffuse.*channel) / (highlight.*channel));
  return highlight * factor;
}

MaterialModel model_of(const Statements& m) {
  const bool reflects = m.illum == 3 || m.illum == 5 || m.illum == 8;
  const bool refracts = m.illum == 4 || m.illum == 6 || m.illum == 7 || m.illum == 9;
  if (refracts || (is_transparent(m) && m.ior > 1))
    return Glass{m.ior > 1 ? m.ior : Glass{}.ior, {}, {is_black(m.tf) ? Rgb::gray(1) : m.tf, -1}};
  if (reflects && !is_black(m.ks)) return Mirror{{at_most_one(m.ks), -1}};
  // Exporters write a black Kd beside a texture and mean the texture.
  const bool only_texture = !m.albedo_map.file.empty() && is_black(m.kd);
  const Rgb diffuse = only_texture ? Rgb::gray(1) : m.kd;
  if (m.illum != 2 || m.exponent <= 0 || is_black(m.ks)) return Lambert{{diffuse, -1}};
  // Beside a texture it is the material that scales, where the texture is bright.
  const Rgb highlight = at_most_one(m.ks);
  Phong phong;
  phong.diffuse.value = diffuse;
  phong.specular.value = m.albedo_map.file.empty() ? highlight_beside(diffuse, highlight) : highlight;
  phong.exponent.value = std::min(m.exponent, kMaxExponent);
  return phong;
}

MtlMaterial convert(const Statements& m) {
  MtlMaterial result;
  result.material = {m.name, model_of(m), m.ke};
  if (std::holds_alternative<Mirror>(result.material.model) ||
      std::holds_alternative<Glass>(result.material.model))
    return result;
  result.albedo_file = m.albedo_map.file;
  result.albedo_line = m.albedo_line;
  result.wrap = m.albedo_map.clamp ? Wrap::kClamp : Wrap::kRepeat;
  result.scale = m.albedo_map.scale;
  result.offset = m.albedo_map.offset;
  return result;
}

class MtlReader {
 public:
  explicit MtlReader(std::string_view text) : rest_(text) {}

  Result<std::vector<MtlMaterial>> read(const std::string& name);

 private:
  Status statement(std::string_view line);
  Status new_material(std::string_view line);
  Status color(const ColorRule& rule, std::string_view line);
  Status number(const NumberRule& rule, std::string_view line);
  Status albedo_map(std::string_view line);

  std::string_view rest_;
  int line_number_ = 0;
  std::vector<Statements> materials_;
};

Result<std::vector<MtlMaterial>> MtlReader::read(const std::string& name) {
  while (!rest_.empty()) {
    ++line_number_;
    if (auto ok = statement(take_line(rest_)); !ok)
      return fail(ok.error().within(fmt::format("{}:{}", name, line_number_)));
  }
  std::vector<MtlMaterial> result;
  for (const auto& material : materials_) result.push_back(convert(material));
  return result;
}

Status MtlReader::statement(std::string_view line) {
  const std::string_view keyword = take_word(line);
  if (keyword == "newmtl") return new_material(line);
  const auto* color_rule = find_rule(kColors, keyword);
  const auto* number_rule = find_rule(kNumbers, keyword);
  const bool is_map = keyword == "map_Kd";
  if (color_rule == nullptr && number_rule == nullptr && !is_map) return {};
  if (materials_.empty())
    return mistake(fmt::format("'{}' belongs to no material; a 'newmtl' must come before it", keyword));
  if (is_map) return albedo_map(line);
  return color_rule != nullptr ? color(*color_rule, line) : number(*number_rule, line);
}

Status MtlReader::new_material(std::string_view line) {
  const std::string_view name = trimmed(line);
  if (name_without_comment(name).empty()) return mistake("'newmtl' needs a name");
  materials_.emplace_back().name = name;
  return {};
}

// Of a single number the three are equal.
Status MtlReader::color(const ColorRule& rule, std::string_view line) {
  std::array<float, 3> c{};
  const auto count = read_numbers(line, c, 3);
  if (count == 1) c[1] = c[2] = c[0];
  const bool in_range = std::all_of(c.begin(), c.end(), [&](float x) { return x >= 0 && x <= rule.max; });
  if ((count != 1 && count != 3) || !in_range)
    return mistake(fmt::format("'{}' must be 3 numbers between 0 and {}, got {}", rule.keyword, rule.max,
                               in_quotes(line)));
  materials_.back().*rule.color = {c[0], c[1], c[2]};
  return {};
}

Status MtlReader::number(const NumberRule& rule, std::string_view line) {
  std::string_view rest = line;
  const bool halo = rule.keyword == "d" && take_word(rest) == "-halo";
  std::array<float, 1> x{};
  if (read_numbers(halo ? rest : line, x, 1) != 1 || !(x[0] >= rule.min && x[0] <= rule.max))
    return mistake(fmt::format("'{}' must be a number between {} and {}, got {}", rule.keyword, rule.min,
                               rule.max, in_quotes(line)));
  materials_.back().*rule.number = x[0];
  return {};
}

Status MtlReader::albedo_map(std::string_view line) {
  auto map = read_mtl_map("map_Kd", line);
  if (!map) return fail(map.error());
  materials_.back().albedo_map = std::move(*map);
  materials_.back().albedo_line = line_number_;
  return {};
}

}  // namespace

Result<std::vector<MtlMaterial>> read_mtl(std::string_view bytes, const std::string& name) {
  return MtlReader(without_byte_order_mark(bytes)).read(name);
}

}  // namespace tessera::core
