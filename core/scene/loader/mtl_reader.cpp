#include "core/scene/loader/mtl_reader.hpp"

#include <fmt/format.h>
#include <tiny_obj_loader.h>

#include <algorithm>
#include <array>
#include <map>

#include "core/scene/loader/memory_stream.hpp"
#include "core/scene/loader/suggestion.hpp"
#include "core/scene/loader/text_lines.hpp"

namespace tessera::core {
namespace {

// The statements whose numbers are used: how many there are, and the range they must keep to.
struct Rule {
  std::string_view keyword;
  int count;
  float max;
};
constexpr float kLargestRadiance = 1e30f;
constexpr std::array kRules{Rule{"Kd", 3, 1},
                            Rule{"Ks", 3, 1},
                            Rule{"Tf", 3, 1},
                            Rule{"Kt", 3, 1},
                            Rule{"Ke", 3, kLargestRadiance},
                            Rule{"d", 1, 1},
                            Rule{"Tr", 1, 1},
                            Rule{"Ni", 1, 10},
                            Rule{"illum", 1, 10}};

Status check_statement(std::string_view line) {
  const std::string_view keyword = take_word(line);
  if (keyword == "newmtl" && trimmed(line).empty())
    return fail(ErrorCode::kInvalidArgument, "'newmtl' needs a name");
  const auto* rule =
      std::find_if(kRules.begin(), kRules.end(), [&](const Rule& r) { return r.keyword == keyword; });
  if (rule == kRules.end()) return {};
  int count = 0;
  std::string_view numbers = line;
  for (auto word = take_word(numbers); !word.empty(); word = take_word(numbers), ++count) {
    const auto number = parse_float(word);
    if (!number || *number < 0 || *number > rule->max) count = rule->count;  // one too many in the end
  }
  if (count == rule->count) return {};
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

MaterialModel model_of(const tinyobj::material_t& m) {
  const bool reflects = m.illum == 3 || m.illum == 5 || m.illum == 8;
  const bool refracts = m.illum == 4 || m.illum == 6 || m.illum == 7 || m.illum == 9;
  if (refracts || (m.dissolve < 1 && m.ior > 1)) {
    const Rgb filter = color(m.transmittance);
    return Glass{m.ior > 1 ? m.ior : Glass{}.ior, {}, {is_black(filter) ? Rgb::gray(1) : filter, -1}};
  }
  if (reflects && !is_black(color(m.specular))) return Mirror{{color(m.specular), -1}};
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

Result<std::vector<MtlMaterial>> read_mtl(const std::string& bytes, const std::string& name) {
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
