// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/mtl_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "core/base/letter_case.hpp"
#include "core/scene/loader/mtl_material.hpp"
#include "core/scene/loader/text_lines.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

constexpr float kLargest = 1e30f;  // for values without an upper limit of 1

struct ColorRule {
  std::string_view keyword;
  float max;
  std::optional<Rgb> MtlMaterial::*color;
};
constexpr std::array kColors{ColorRule{"Ka", kLargest, &MtlMaterial::ambient},
                             ColorRule{"Kd", 1, &MtlMaterial::diffuse},
                             ColorRule{"Ks", kLargest, &MtlMaterial::specular},
                             ColorRule{"Tf", 1, &MtlMaterial::transmission},
                             ColorRule{"Kt", 1, &MtlMaterial::transmission},
                             ColorRule{"Ke", kLargest, &MtlMaterial::emission},
                             ColorRule{"Ps", 1, &MtlMaterial::sheen}};

// The treatment of numbers out of range: clamped, or ignored.
enum class OutOfRange { kClamp, kIgnore };
struct NumberRule {
  std::string_view keyword;
  float min, max;
  std::optional<float> MtlMaterial::*number;
  OutOfRange out_of_range = OutOfRange::kClamp;
};
// Some programs write a negative Ns for surfaces without highlights.
constexpr std::array kNumbers{NumberRule{"d", 0, 1, &MtlMaterial::dissolve},
                              NumberRule{"Tr", 0, 1, &MtlMaterial::transparency},
                              NumberRule{"Ni", 0, 10, &MtlMaterial::ior, OutOfRange::kIgnore},
                              NumberRule{"Ns", -kLargest, kLargest, &MtlMaterial::exponent},
                              NumberRule{"illum", 0, 10, &MtlMaterial::illum, OutOfRange::kIgnore},
                              NumberRule{"Pr", 0, 1, &MtlMaterial::roughness},
                              NumberRule{"Pm", 0, 1, &MtlMaterial::metallic},
                              NumberRule{"Pc", 0, 4, &MtlMaterial::coat},
                              NumberRule{"Pcr", 0, 1, &MtlMaterial::coat_roughness},
                              NumberRule{"aniso", 0, 1, &MtlMaterial::anisotropy},
                              NumberRule{"anisor", -kLargest, kLargest, &MtlMaterial::anisotropy_rotation}};

struct MapRule {
  std::string_view keyword;
  std::optional<MtlMap> MtlMaterial::*map;
};
constexpr std::array kMaps{MapRule{"map_Kd", &MtlMaterial::diffuse_map},
                           MapRule{"map_Ks", &MtlMaterial::specular_map},
                           MapRule{"map_Ke", &MtlMaterial::emission_map},
                           MapRule{"map_d", &MtlMaterial::dissolve_map},
                           MapRule{"map_Ns", &MtlMaterial::exponent_map},
                           MapRule{"map_Pr", &MtlMaterial::roughness_map},
                           MapRule{"map_Pm", &MtlMaterial::metallic_map},
                           MapRule{"map_Ps", &MtlMaterial::sheen_map},
                           MapRule{"map_Pc", &MtlMaterial::coat_map},
                           MapRule{"map_Pcr", &MtlMaterial::coat_roughness_map},
                           MapRule{"norm", &MtlMaterial::normal_map},
                           MapRule{"map_norm", &MtlMaterial::normal_map},
                           MapRule{"bump", &MtlMaterial::bump_map},
                           MapRule{"map_bump", &MtlMaterial::bump_map},
                           MapRule{"bm", &MtlMaterial::bump_map},
                           MapRule{"map_opacity", &MtlMaterial::dissolve_map},
                           MapRule{"map_emissive", &MtlMaterial::emission_map}};

// Ignored silently: ambient light is not supported, and "sharpness" only modifies "refl", which is reported.
constexpr std::array<std::string_view, 2> kSilent{"map_Ka", "sharpness"};

template <typename Rules>
const auto* find_rule(const Rules& rules, std::string_view keyword) {
  const auto* found = std::find_if(rules.begin(), rules.end(), [&](const auto& rule) {
    return equal_ignoring_case(rule.keyword, keyword);
  });
  return found == rules.end() ? nullptr : found;
}

bool is_one_of(std::span<const std::string_view> words, std::string_view keyword) {
  return std::any_of(words.begin(), words.end(),
                     [&](auto word) { return equal_ignoring_case(word, keyword); });
}

class MtlReader {
 public:
  MtlReader(std::string_view text, const WarningLimits& warnings) : rest_(text) {
    file_.warnings = FileWarnings(warnings);
  }

  MtlFile read();

 private:
  void statement(std::string_view line);
  void new_material(std::string_view line);
  void end_material();
  void color(const ColorRule& rule, std::string_view line);
  void number(const NumberRule& rule, std::string_view line);
  void map(const MapRule& rule, std::string_view keyword, std::string_view line);
  void unused(std::string_view keyword);

  template <typename Text>
  void warn(std::string_view kind, const Text& text) {
    file_.warnings.add(kind, line_number_, text);
  }
  MtlMaterial& material() { return file_.materials.back(); }

  std::string_view rest_;
  int line_number_ = 0;
  MtlFile file_;
  std::set<std::string, std::less<>> names_;
};

MtlFile MtlReader::read() {
  while (!rest_.empty()) {
    ++line_number_;
    statement(take_line(rest_));
  }
  end_material();
  return std::move(file_);
}

void MtlReader::statement(std::string_view line) {
  const std::string_view keyword = take_word(line);
  if (keyword.empty() || keyword.front() == '#') return;
  if (equal_ignoring_case(keyword, "newmtl")) return new_material(line);
  const auto* color_rule = find_rule(kColors, keyword);
  const auto* number_rule = find_rule(kNumbers, keyword);
  const auto* map_rule = find_rule(kMaps, keyword);
  if (color_rule == nullptr && number_rule == nullptr && map_rule == nullptr) return unused(keyword);
  if (file_.materials.empty())
    return warn("no newmtl", [&] {
      return fmt::format("'{}' belongs to no material, because no 'newmtl' comes before it; it is ignored",
                         keyword);
    });
  if (color_rule != nullptr) return color(*color_rule, line);
  if (number_rule != nullptr) return number(*number_rule, line);
  map(*map_rule, keyword, line);
}

// MeshLab writes the opacity, not the transparency, as 'Tr' alone. A surface that nobody can see is taken for
// an opaque one.
void MtlReader::end_material() {
  if (file_.materials.empty() || material().transparency != 1 || material().dissolve ||
      material().dissolve_map)
    return;
  material().transparency.reset();
  warn("Tr 1", [&] {
    return fmt::format("'Tr 1' without 'd' would hide all of the material {}; it is taken for opaque",
                       in_quotes(material().name));
  });
}

void MtlReader::new_material(std::string_view line) {
  end_material();
  const std::string_view name = trimmed(line);
  file_.materials.emplace_back();
  if (name_without_comment(name).empty())
    return warn("newmtl", [] { return "'newmtl' gives no name; the material is ignored"; });
  material().name = name;
  if (!names_.emplace(name).second)
    warn(fmt::format("repeated {}", name), [&] {
      return fmt::format("the material {} is defined again; the last one is used", in_quotes(name));
    });
}

// A single number applies to all three channels.
void MtlReader::color(const ColorRule& rule, std::string_view line) {
  std::array<float, 3> c{};
  const Numbers numbers = read_numbers(line, c);
  if (numbers.count == 1 && numbers.words == 1) c[1] = c[2] = c[0];
  const bool readable = numbers.count >= 3 || (numbers.count == 1 && numbers.words == 1);
  const auto clamped = [&](float x) { return std::clamp(x, 0.0f, rule.max); };
  const bool in_range = std::all_of(c.begin(), c.end(), [&](float x) { return x == clamped(x); });
  if (readable) material().*rule.color = Rgb{clamped(c[0]), clamped(c[1]), clamped(c[2])};
  if (!readable && rule.color == &MtlMaterial::diffuse) material().diffuse = kDefaultDiffuse;
  if (readable && in_range && numbers.words <= 3) return;
  warn(fmt::format("{} {}", rule.keyword, readable), [&] {
    return fmt::format("'{}' must be 3 numbers between 0 and {}, got {}; {}", rule.keyword, rule.max,
                       in_quotes(line), readable ? "it is clamped" : "the default is used");
  });
}

void MtlReader::number(const NumberRule& rule, std::string_view line) {
  std::string_view value = line;
  if (rule.keyword == "d" && take_word(value) != "-halo") value = line;
  std::array<float, 1> x{};
  const Numbers numbers = read_numbers(value, x);
  const float clamped = std::clamp(x[0], rule.min, rule.max);
  const bool in_range = x[0] == clamped;
  const bool usable = numbers.count >= 1 && (in_range || rule.out_of_range == OutOfRange::kClamp);
  if (usable) material().*rule.number = clamped;
  if (usable && in_range && numbers.words == 1) return;
  warn(fmt::format("{} {}", rule.keyword, usable), [&] {
    return fmt::format("'{}' must be a number between {} and {}, got {}; {}", rule.keyword, rule.min,
                       rule.max, in_quotes(line),
                       usable ? fmt::format("{} is used", clamped) : "the default is used");
  });
}

void MtlReader::map(const MapRule& rule, std::string_view keyword, std::string_view line) {
  if (auto map = read_mtl_map(keyword, line, line_number_, file_.warnings))
    material().*rule.map = std::move(*map);
}

void MtlReader::unused(std::string_view keyword) {
  if (is_one_of(kSilent, keyword)) return;
  warn(fmt::format("unused {}", keyword), [&] { return fmt::format("{} is not used", in_quotes(keyword)); });
}

}  // namespace

MtlFile read_mtl(std::string_view bytes, const WarningLimits& warnings) {
  std::string converted;
  return MtlReader(as_utf8(bytes, converted), warnings).read();
}

}  // namespace tessera::core
