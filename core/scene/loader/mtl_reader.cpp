#include "core/scene/loader/mtl_reader.hpp"

#include <fmt/format.h>
#include <tiny_obj_loader.h>

#include <algorithm>
#include <array>
#include <map>

#include "core/scene/loader/memory_stream.hpp"
#include "core/scene/loader/text_lines.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

// The statements whose numbers are used: how many there are, from 0 to which.
struct Rule {
  std::string_view keyword;
  int count;
  float max;
};
constexpr float kLargest = 1e30f;  // of what may be greater than 1
constexpr std::array kRules{Rule{"Kd", 3, 1}, Rule{"Ks", 3, kLargest}, Rule{"Tf", 3, 1},
                            Rule{"Kt", 3, 1}, Rule{"Ke", 3, kLargest}, Rule{"d", 1, 1},
                            Rule{"Tr", 1, 1}, Rule{"Ni", 1, 10},       Rule{"illum", 1, 10}};

Status check_statement(std::string_view line) {
  const std::string_view keyword = take_word(line);
  if (keyword == "newmtl" && trimmed(line).empty())
    return fail(ErrorCode::kInvalidArgument, "'newmtl' needs a name");
  const auto* rule =
      std::find_if(kRules.begin(), kRules.end(), [&](const Rule& r) { return r.keyword == keyword; });
  if (rule == kRules.end()) return {};
  std::array<float, 3> numbers{};
  const auto in_range = [&](float number) { return number >= 0 && number <= rule->max; };
  if (read_numbers(line, numbers, rule->count) == rule->count &&
      std::all_of(numbers.begin(), numbers.end(), in_range))
    return {};
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("'{}' must be {} between 0 and {}, got {}", keyword,
                          rule->count == 1 ? "a number" : "3 numbers", rule->max, in_quotes(line)));
}

Status check_mtl(std::string_view text, const std::string& name) {
  for (int line = 1; !text.empty(); ++line)
    if (auto ok = check_statement(take_line(text)); !ok)
      return fail(ok.error().within(fmt::format("{}:{}", name, line)));
  return {};
}

Rgb color(const float (&c)[3]) {
  return {c[0], c[1], c[2]};
}

// Ks is used for highlights, too, which may be brighter than a mirror can be.
Rgb at_most_one(Rgb c) {
  return {std::min(c.r, 1.0f), std::min(c.g, 1.0f), std::min(c.b, 1.0f)};
}

MaterialModel model_of(const tinyobj::material_t& m) {
  const bool reflects = m.illum == 3 || m.illum == 5 || m.illum == 8;
  const bool refracts = m.illum == 4 || m.illum == 6 || m.illum == 7 || m.illum == 9;
  if (refracts || (m.dissolve < 1 && m.ior > 1)) {
    const Rgb filter = color(m.transmittance);
    return Glass{m.ior > 1 ? m.ior : Glass{}.ior, {}, {is_black(filter) ? Rgb::gray(1) : filter, -1}};
  }
  if (reflects && !is_black(color(m.specular))) return Mirror{{at_most_one(color(m.specular)), -1}};
  // Exporters write a black Kd beside a texture and mean the texture.
  const bool only_texture = !m.diffuse_texname.empty() && is_black(color(m.diffuse));
  return Lambert{{only_texture ? Rgb::gray(1) : color(m.diffuse), -1}};
}

MtlMaterial convert(const tinyobj::material_t& m) {
  MtlMaterial result;
  result.material = {std::string(trimmed(m.name)), model_of(m), color(m.emission)};
  if (!std::holds_alternative<Lambert>(result.material.model)) return result;
  result.albedo_file = trimmed(m.diffuse_texname);
  std::replace(result.albedo_file.begin(), result.albedo_file.end(), '\\', '/');
  const auto& options = m.diffuse_texopt;
  result.wrap = options.clamp ? Wrap::kClamp : Wrap::kRepeat;
  result.scale = {options.scale[0], options.scale[1]};
  result.offset = {options.origin_offset[0], options.origin_offset[1]};
  return result;
}

}  // namespace

Result<std::vector<MtlMaterial>> read_mtl(std::string_view bytes, const std::string& name) {
  bytes = without_byte_order_mark(bytes);
  if (auto ok = check_mtl(bytes, name); !ok) return fail(ok.error());
  std::map<std::string, int> indices;
  std::vector<tinyobj::material_t> materials;
  std::string warnings, errors;
  MemoryStream stream(bytes);
  tinyobj::LoadMtl(&indices, &materials, &stream, &warnings, &errors);
  std::vector<MtlMaterial> result;
  for (const auto& material : materials)
    if (!material.name.empty()) result.push_back(convert(material));
  return result;
}

}  // namespace tessera::core
