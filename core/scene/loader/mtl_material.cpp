// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/mtl_material.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <variant>

namespace tessera::core {
namespace {

// Blender writes the specular level of its Principled BSDF as Ks, where the reflectance at normal incidence
// is 0.08 times that, and the roughness r as Ns = 1000 (1 - r)^2.
constexpr float kReflectanceOfSpecular = 0.08f, kMaxBlenderExponent = 1000;
constexpr float kDefaultSpecular = 0.5f, kDefaultRoughness = 0.5f;
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

// Converts one material, given its textures.
class Converter {
 public:
  Converter(const MtlMaterial& material, const MtlTextures& textures) : m_(material), textures_(textures) {}

  Material convert() const;

 private:
  bool has_illum(std::initializer_list<float> models) const {
    return m_.illum && std::find(models.begin(), models.end(), *m_.illum) != models.end();
  }
  bool is_physically_based() const {
    return m_.roughness || m_.metallic || m_.roughness_map || m_.metallic_map;
  }
  // The opacity, from d or else from Tr.
  float share_that_is_met() const { return m_.dissolve.value_or(1 - m_.transparency.value_or(0)); }
  bool is_glass() const;
  float metallic() const;
  ScalarParameter roughness() const;
  ColorParameter diffuse() const;
  Rgb specular() const;
  ScalarParameter opacity() const;
  ColorParameter emission() const;
  Glass glass() const;
  MaterialModel reflector() const;
  MaterialModel microfacets(const ColorParameter& base, float metallic) const;
  MaterialModel model() const;

  const MtlMaterial& m_;
  const MtlTextures& textures_;
};

// Maya writes illum 4 for every material, with Ni 1. A cut-out textured card is not glass, and Blender's
// materials with illum 9 and d below 1 transmit without refraction.
bool Converter::is_glass() const {
  if (m_.dissolve_map) return false;
  if (has_illum({4})) return m_.ior.value_or(1) > 1 && !m_.diffuse_map;
  if (has_illum({9})) return share_that_is_met() == 1 || share_that_is_met() == 0;
  return has_illum({6, 7});
}

// Blender writes metallic as Ka with illum 3.
float Converter::metallic() const {
  if (textures_.metallic) return *textures_.metallic;
  if (is_physically_based()) return m_.metallic.value_or(0);
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

// d overrides a contradictory Tr. A d of 0 with a map means the map. Maya writes Tf as 1 minus the
// transparency.
ScalarParameter Converter::opacity() const {
  float value = share_that_is_met();
  const bool is_maya = has_illum({4}) && !m_.dissolve && !m_.transparency;
  if (is_maya && m_.transmission && !is_black(*m_.transmission))
    value = (m_.transmission->r + m_.transmission->g + m_.transmission->b) / 3;
  if (textures_.opacity >= 0 && value == 0) value = 1;
  return {value, textures_.opacity};
}

ColorParameter Converter::emission() const {
  const Rgb color = m_.emission.value_or(Rgb{});
  return {textures_.emission >= 0 && is_black(color) ? Rgb::gray(1) : color, textures_.emission};
}

Glass Converter::glass() const {
  Glass glass;
  if (m_.ior.value_or(1) > 1) glass.ior = *m_.ior;
  const Rgb filter = m_.transmission.value_or(Rgb{});
  glass.transmittance = {is_black(filter) ? Rgb::gray(1) : filter, textures_.diffuse};
  if (m_.roughness || textures_.roughness >= 0) glass.roughness = roughness();
  return glass;
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

// "Reflection on" without Pm and Pr: a mirror if it is sharp, tinted by the brighter of Ks and Kd, else a
// metal of colour Kd. Ray tracers write sharp reflections without Ns.
MaterialModel Converter::reflector() const {
  const ColorParameter base = diffuse(), sharp{specular(), -1};
  const bool is_sharp = m_.exponent.value_or(kMirrorExponent) >= kMirrorExponent;
  if (is_black(base.value)) return is_sharp ? MaterialModel(Mirror{sharp}) : microfacets(sharp, 1);
  const bool is_tinted_by_base = base.texture >= 0 || max_component(base.value) >= max_component(sharp.value);
  const bool is_mirror = is_sharp && metallic() == 1 && (m_.exponent || !is_tinted_by_base);
  return is_mirror ? MaterialModel(Mirror{is_tinted_by_base ? base : sharp}) : microfacets(base, metallic());
}

MaterialModel Converter::model() const {
  if (is_glass()) return glass();
  if (is_physically_based()) return microfacets(diffuse(), metallic());
  const bool reflects = has_illum({3, 5, 8}), has_highlight = !m_.illum || has_illum({2});
  const bool is_shiny = !is_black(specular());
  if (reflects && is_shiny) return reflector();
  const bool is_matt = !has_highlight || !is_shiny || !(m_.exponent.value_or(0) > 0);
  if (is_matt && textures_.roughness < 0) return Lambert{diffuse()};
  const ColorParameter base = diffuse();
  // Without a diffuse part it is a metal of colour Ks.
  if (is_black(base.value)) return microfacets({specular(), textures_.specular}, 1);
  return microfacets(base, 0);
}

Material Converter::convert() const {
  Material material{m_.name, model()};
  material.emission = emission();
  material.opacity = std::holds_alternative<Glass>(material.model) ? ScalarParameter(1) : opacity();
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
