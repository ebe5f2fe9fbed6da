// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/mtl_material.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>

#include "core/materials/fresnel.hpp"

namespace tessera::core {
namespace {

// Blender writes the specular level of its Principled BSDF as Ks, where the reflectance at normal incidence
// is 0.08 times that, and the roughness r as Ns = 1000 (1 - r)^2.
constexpr float kReflectanceOfSpecular = 0.08f, kMaxBlenderExponent = 1000;
constexpr float kDefaultSpecular = 0.5f, kDefaultRoughness = 0.5f, kDefaultIor = 1.5f;
// Blender writes four times the weight of its coat: earlier, a clear coat of 1 reflected a quarter.
constexpr float kCoatOfPc = 0.25f;
// The level of Ks at which the reflectance is that of the index, as Blender has it.
constexpr float kLevelOfIndex = 0.5f;
// Exponents from here on are perfect mirrors.
constexpr float kMirrorExponent = 999;
// The minimum share of highlights, however bright the diffuse part.
constexpr float kMinHighlight = 0.05f;

bool is_grey(Rgb c) {
  return c.r == c.g && c.g == c.b;
}

Rgb at_most_one(Rgb c) {
  return {std::min(c.r, 1.0f), std::min(c.g, 1.0f), std::min(c.b, 1.0f)};
}

Rgb mix(Rgb a, Rgb b, float share_of_b) {
  return a * (1 - share_of_b) + b * share_of_b;
}

// A map replaces its number: programs write the value of an input that is linked to an image as well.
ScalarParameter mapped(const std::optional<float>& number, int texture, float otherwise) {
  return texture >= 0 ? ScalarParameter(1, texture) : ScalarParameter(number.value_or(otherwise));
}

bool is_positive(const std::optional<float>& number) {
  return number.value_or(0) > 0;
}

// Converts one material, given its textures.
class Converter {
 public:
  Converter(const MtlMaterial& material, const MtlTextures& textures) : m_(material), textures_(textures) {}

  Material convert() const;

 private:
  bool has_illum(std::initializer_list<float> models) const {
    return m_.illum && std::find(models.begin(), models.end(), *m_.illum) != models.end();
  }
  bool is_physically_based() const;
  bool has_metal() const { return textures_.metallic >= 0 || is_positive(m_.metallic); }
  // Maya writes Tf as 1 minus the transparency.
  bool is_transparent_by_filter() const { return has_illum({4}) && !m_.dissolve && !m_.transparency; }
  Rgb filter() const { return m_.transmission.value_or(Rgb{}); }
  float index() const { return m_.ior.value_or(1) > 1 ? *m_.ior : kDefaultIor; }
  // The opacity, from d or else from Tr.
  float share_that_is_met() const { return m_.dissolve.value_or(1 - m_.transparency.value_or(0)); }
  bool has_weight_of_transmission() const;
  bool refracts() const;
  float metallic_of_ambient() const;
  bool is_plastic_of_blender() const;
  ScalarParameter roughness() const;
  ColorParameter diffuse() const;
  Rgb specular() const;
  ScalarParameter opacity() const;
  ColorParameter emission() const;
  Glass glass() const;
  Principled principled() const;
  void add_transmission(Principled& model) const;
  void add_gloss(Principled& model) const;
  void add_anisotropy(Principled& model) const;
  void add_coat(Principled& model) const;
  void add_sheen(Principled& model) const;
  MaterialModel reflector() const;
  MaterialModel microfacets(const ColorParameter& base, float metallic) const;
  MaterialModel model() const;

  const MtlMaterial& m_;
  const MtlTextures& textures_;
};

// Layers of 0 alone do not count: some programs write them beside Ks and Ns that say more.
bool Converter::is_physically_based() const {
  return m_.roughness || m_.metallic || m_.roughness_map || m_.metallic_map || m_.coat_map || m_.sheen_map ||
         is_positive(m_.coat) || is_positive(m_.anisotropy) || (m_.sheen && !is_black(*m_.sheen));
}

// Blender, where Tf is the weight of transmission, writes none of these keys beside the physically based
// ones; others write Tf 1 1 1 for every material.
bool Converter::has_weight_of_transmission() const {
  return !is_black(filter()) && !has_illum({4}) && !m_.transparency && !m_.exponent && !m_.ambient;
}

// Maya writes illum 4 for every material, with Ni 1. A cut-out textured card is not glass, and Blender's
// materials with illum 9 and d below 1 transmit without refraction. It writes illum 6 for transparent metal.
bool Converter::refracts() const {
  if (m_.dissolve_map || has_metal()) return false;
  if (has_illum({4})) return m_.ior.value_or(1) > 1 && !m_.diffuse_map;
  if (has_illum({9})) return !is_physically_based() && (share_that_is_met() == 1 || share_that_is_met() == 0);
  return has_illum({6, 7});
}

// Blender writes illum 3 for metal, and a gray Ks for plastic.
bool Converter::is_plastic_of_blender() const {
  return has_illum({2}) && m_.ambient == Rgb::gray(1) && is_grey(specular());
}

// Blender writes metallic as Ka with illum 3.
float Converter::metallic_of_ambient() const {
  const Rgb ambient = m_.ambient.value_or(Rgb{});
  return is_grey(ambient) && ambient.r > 0 && ambient.r <= 1 ? ambient.r : 1;
}

ScalarParameter Converter::roughness() const {
  if (textures_.roughness >= 0) return {1, textures_.roughness};
  if (m_.roughness) return *m_.roughness;
  if (!m_.exponent) return kDefaultRoughness;
  return 1 - std::sqrt(std::clamp(*m_.exponent, 0.0f, kMaxBlenderExponent) / kMaxBlenderExponent);
}

// A black Kd with a texture means the texture, as several programs write it.
ColorParameter Converter::diffuse() const {
  const bool says_nothing = !m_.specular && !m_.emission && !m_.transmission && !m_.emission_map;
  const Rgb color = m_.diffuse.value_or(says_nothing ? kDefaultDiffuse : Rgb{});
  if (!m_.diffuse_map || !is_black(color)) return {color, textures_.diffuse};
  return {textures_.diffuse >= 0 ? Rgb::gray(1) : kDefaultDiffuse, textures_.diffuse};
}

Rgb Converter::specular() const {
  const Rgb color =
      at_most_one(m_.specular.value_or(is_physically_based() ? Rgb::gray(kDefaultSpecular) : Rgb{}));
  return textures_.specular >= 0 && is_black(color) ? Rgb::gray(1) : color;
}

// d overrides a contradictory Tr. A d of 0 with a map means the map.
ScalarParameter Converter::opacity() const {
  float value = share_that_is_met();
  if (is_transparent_by_filter() && !is_black(filter())) value = (filter().r + filter().g + filter().b) / 3;
  if (textures_.opacity >= 0 && value == 0) value = 1;
  return {value, textures_.opacity};
}

ColorParameter Converter::emission() const {
  const Rgb color = m_.emission.value_or(Rgb{});
  return {textures_.emission >= 0 && is_black(color) ? Rgb::gray(1) : color, textures_.emission};
}

Glass Converter::glass() const {
  Glass glass;
  glass.ior = index();
  glass.transmittance = {is_black(filter()) ? Rgb::gray(1) : filter(), textures_.diffuse};
  if (textures_.roughness >= 0) glass.roughness = roughness();
  return glass;
}

// With the keys of the physically based extension, as Blender writes and reads them.
Principled Converter::principled() const {
  Principled model;
  model.base_color = diffuse();
  model.base_metalness = mapped(m_.metallic, textures_.metallic, 0);
  model.specular_roughness = roughness();
  add_transmission(model);
  add_gloss(model);
  add_anisotropy(model);
  add_coat(model);
  add_sheen(model);
  return model;
}

// Tf is the weight of transmission here, and the base colour tints it; but a filter where illum refracts.
void Converter::add_transmission(Principled& model) const {
  if (refracts()) {
    model.transmission_weight = 1;
    model.transmission_color = {is_black(filter()) ? Rgb::gray(1) : filter(), textures_.diffuse};
  } else if (has_weight_of_transmission()) {
    const float weight = max_component(filter());
    model.transmission_weight = weight;
    model.transmission_color = {model.base_color.value * (filter() / weight), model.base_color.texture};
  }
}

// Ks scales the reflectance of the dielectric part. The weight would scale that of metal, too, so the index
// does it where nothing is refracted by that index.
void Converter::add_gloss(Principled& model) const {
  if (model.base_metalness.texture < 0 && model.base_metalness.value >= 1) return;
  const float level = max_component(specular()), scale = level / kLevelOfIndex;
  model.specular_color = {level > 0 ? specular() / level : Rgb::gray(1), textures_.specular};
  if (model.transmission_weight.value > 0) {
    model.specular_ior = index();
    model.specular_weight = std::min(scale, 1.0f);
  } else {
    model.specular_ior = index_of_reflectance(scale * normal_reflectance(index()), kMaxIor);
  }
}

// Burley 2012, section 5.4, has the ratio 1 - 0.9 aniso of both roughnesses at a geometric mean that stays;
// OpenPBR 1.1 a mean square that stays.
void Converter::add_anisotropy(Principled& model) const {
  if (!is_positive(m_.anisotropy)) return;
  const float stretch = 0.9f * *m_.anisotropy, ratio = 1 - stretch;
  const float factor = std::sqrt(std::sqrt((1 + ratio * ratio) / (2 * ratio)));
  ScalarParameter& roughness = model.specular_roughness;
  roughness.value *= factor;
  if (roughness.texture < 0) roughness.value = std::min(roughness.value, 1.0f);
  model.specular_roughness_anisotropy = stretch;
  const float turns = m_.anisotropy_rotation.value_or(0);
  model.tangent.rotation = turns - std::round(turns);
}

void Converter::add_coat(Principled& model) const {
  if (textures_.coat < 0 && !is_positive(m_.coat)) return;
  model.coat_weight = mapped(kCoatOfPc * m_.coat.value_or(0), textures_.coat, 0);
  model.coat_roughness = mapped(m_.coat_roughness, textures_.coat_roughness, 0);
  model.coat_ior = kDefaultIor;
  model.coat_darkening = 0;
}

void Converter::add_sheen(Principled& model) const {
  const Rgb color = m_.sheen.value_or(Rgb{});
  if (textures_.sheen >= 0) {
    model.fuzz_weight = {1, textures_.sheen};
  } else if (!is_black(color)) {
    model.fuzz_weight = max_component(color);
    model.fuzz_color = {color / max_component(color)};
  }
}

// If `metallic` is below 1, a textured base colour tints all reflection, because only one texture is
// available.
MaterialModel Converter::microfacets(const ColorParameter& base, float metallic) const {
  CookTorrance model;
  if (metallic < 1) model.diffuse = {base.value * (1 - metallic), base.texture};
  const Rgb of_dielectric = specular() * kReflectanceOfSpecular;
  model.f0 = {mix(of_dielectric, base.value, metallic), metallic > 0 ? base.texture : textures_.specular};
  model.specular.value = Rgb::gray(std::max(1 - max_component(model.diffuse.value), kMinHighlight));
  model.roughness = roughness();
  return model;
}

// "Reflection on": a mirror if it is sharp, tinted by the brighter of Ks and Kd, else a
// metal of colour Kd. Ray tracers write sharp reflections without Ns.
MaterialModel Converter::reflector() const {
  const ColorParameter base = diffuse(), sharp{specular(), -1};
  const bool is_sharp = m_.exponent.value_or(kMirrorExponent) >= kMirrorExponent;
  if (is_black(base.value)) return is_sharp ? MaterialModel(Mirror{sharp}) : microfacets(sharp, 1);
  const bool is_tinted_by_base = base.texture >= 0 || max_component(base.value) >= max_component(sharp.value);
  const float metallic = metallic_of_ambient();
  const bool is_mirror = is_sharp && metallic == 1 && (m_.exponent || !is_tinted_by_base);
  return is_mirror ? MaterialModel(Mirror{is_tinted_by_base ? base : sharp}) : microfacets(base, metallic);
}

MaterialModel Converter::model() const {
  if (is_physically_based()) return principled();
  if (refracts()) return glass();
  const bool reflects = has_illum({3, 5, 8}), has_highlight = !m_.illum || has_illum({2});
  const bool is_shiny = !is_black(specular());
  if (reflects && is_shiny) return reflector();
  const bool is_matt = !has_highlight || !is_shiny || !(m_.exponent.value_or(0) > 0);
  if (is_matt && textures_.roughness < 0) return Lambert{diffuse()};
  const ColorParameter base = diffuse();
  // Without a diffuse part it is a metal of colour Ks, except for what Blender writes for black plastic.
  if (is_black(base.value) && !is_plastic_of_blender())
    return microfacets({specular(), textures_.specular}, 1);
  return microfacets(base, 0);
}

Material Converter::convert() const {
  Material material{m_.name, model()};
  material.emission = emission();
  material.opacity = refracts() ? ScalarParameter(1) : opacity();
  const MtlMaterial::Map& normals = m_.normal_map ? m_.normal_map : m_.bump_map;
  if (textures_.normal >= 0) material.normal_map = {textures_.normal, normals->bump_multiplier};
  if (textures_.bump >= 0) material.bump = {textures_.bump, m_.bump_map->bump_multiplier};
  return material;
}

}  // namespace

Material make_material(const MtlMaterial& material, const MtlTextures& textures) {
  return Converter(material, textures).convert();
}

}  // namespace tessera::core
