// SPDX-License-Identifier: Apache-2.0
#include "core/scene/pbrt/materials.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/math/elementary.hpp"
#include "core/scene/loader/wording.hpp"
#include "core/scene/pbrt/files.hpp"
#include "core/scene/tables/material_tables.hpp"

namespace tessera::core::pbrt {

int Materials::default_material() {
  if (!default_) {
    Material gray;
    gray.name = "default";
    gray.model = Lambert{{Rgb::gray(0.5f), -1}};
    default_ = add(std::move(gray));
  }
  return *default_;
}

// pbrt's BSDFs know the shading normal only.
int Materials::add(Material material) {
  slots_.emplace_back();
  set(static_cast<int>(slots_.size()) - 1, std::move(material));
  return static_cast<int>(slots_.size()) - 1;
}

void Materials::set(int index, Material material) {
  material.shading_normals = ShadingNormals::kPlain;
  Slot& made = slot(index);
  made.is_textured = has_texture(material);
  if (auto* glass = std::get_if<Glass>(&material.model); glass != nullptr && glass->ior.value < 1) {
    glass->ior.value = std::min(1 / glass->ior.value, kMaxIor);
    glass->dispersion.abbe_number /= glass->ior.value;  // the Abbe number of 1 / n, to first order
    made.is_reversed = true;
  }
  made.material = std::move(material);
  made.state = State::kMade;
}

// Parts of mixtures are made before them.
bool Materials::has_texture(const Material& material) const {
  bool found = false;
  visit_keys(material, [&](const auto&, const auto& value) {
    if constexpr (requires { value.texture; }) found |= value.texture >= 0;
  });
  const auto* blend = std::get_if<Blend>(&material.model);
  if (blend == nullptr || found) return found;
  for (const auto& [part, in_scene] : parts_)
    if ((in_scene == blend->first || in_scene == blend->second) && is_textured(part)) return true;
  return false;
}

Result<int> Materials::add(const std::string& type, const Parameters& p, const std::string& name) {
  const std::string shown = name.empty()
                                ? fmt::format("{} {}", type.empty() ? "interface" : type, slots_.size() + 1)
                                : printable(name);
  if (type == "mix")
    if (const Parts parts = parts_of(p); !are_made(parts)) return add_waiting(p, parts, shown);
  auto made = make(type, model(type, p), p, shown);
  if (!made) return fail(made.error());
  return add(std::move(*made));
}

Result<Material> Materials::make(const std::string& type, Model model, const Parameters& p,
                                 const std::string& name) {
  if (!model) return fail(model.error());
  Material material;
  material.name = name;
  material.model = std::move(*model);
  if (auto added = add_relief(p, material); !added) return fail(added.error());
  report_.tell(p, fmt::format("the material '{}'", type));
  return material;
}

Materials::Model Materials::model(const std::string& type, const Parameters& p) {
  p.find("type");
  if (type.empty() || type == "none" || type == "interface") return Null{};
  if (type == "diffuse") return diffuse(p, "reflectance");
  if (type == "coateddiffuse") return coated_diffuse(p);
  if (type == "conductor") return conductor(p);
  if (type == "coatedconductor") return coated_conductor(p);
  if (type == "dielectric") return dielectric(p);
  if (type == "thindielectric") return thin_dielectric(p);
  if (type == "diffusetransmission") return diffuse_transmission(p);
  if (type == "subsurface") return subsurface(p);
  if (type == "hair") return hair(p);
  if (type == "mix") return mix(p, parts_of(p));
  return earlier_model(type, p);
}

Materials::Model Materials::unknown(const std::string& type, const Parameters& p) {
  for (const Parameter& parameter : p.list()) p.find(parameter.name);
  const std::string text =
      type == "measured"
          ? fmt::format(
                "the material 'measured' is refused: the measured reflectance of {} cannot be read; a gray "
                "diffuse material replaces it",
                in_quotes(p.text("filename")))
          : fmt::format("the material {} is not supported; gray is used", in_quotes(type));
  report_.warn(p.place(), text, text);
  return Lambert{{Rgb::gray(0.5f), -1}};
}

Result<ColorParameter> Materials::color(const Parameters& p, std::string_view name, Rgb otherwise) {
  return baker_.color(textures_.color(p, name, SpectrumRole::kAlbedo, otherwise), 1,
                      p.place_of(p.find(name)));
}

Result<ScalarParameter> Materials::scalar(const Parameters& p, std::string_view name, float otherwise,
                                          float most) {
  if (const Parameter* given = p.find(name); given != nullptr && given->type == "float")
    p.number_in(name, otherwise, 0, most);
  return baker_.scalar(textures_.number(p, name, otherwise), most, p.place_of(p.find(name)));
}

namespace {

// Along u, or across it.
TangentDirection tangent_of_rougher(float along_u, float along_v) {
  return {.rotation = along_u < along_v ? 0.25f : 0.0f};
}

}  // namespace

// "remaproughness": alpha is the square root of the roughness, else the roughness itself (pbrt-v4 file
// format, "Materials"). Our roughness is the square root of alpha.
Result<Materials::Roughness> Materials::roughness(const Parameters& p, const std::string& prefix,
                                                  float otherwise, bool may_differ) {
  const float exponent = p.boolean("remaproughness", true) ? 0.25f : 0.5f;
  const TexturePtr both = textures_.number(p, prefix + "roughness", otherwise);
  TexturePtr u = textures_.number(p, prefix + "uroughness"), v = textures_.number(p, prefix + "vroughness");
  if (!u) u = both;
  if (!v) v = both;
  const Place place = p.place();
  const Rgb *along_u = constant_of(u), *along_v = constant_of(v);
  for (const char* name : {"roughness", "uroughness", "vroughness"})
    if (const Parameter* given = p.find(prefix + name); given != nullptr && given->type == "float")
      p.number_in(given->name, otherwise, 0, 1);  // remarks on what is clamped
  const auto ours = [exponent](float r) {
    return static_cast<float>(
        pow(static_cast<double>(std::clamp(r, 0.0f, 1.0f)), static_cast<double>(exponent)));
  };
  if (along_u != nullptr && along_v != nullptr) {
    const float a = ours(along_u->r) * ours(along_u->r), b = ours(along_v->r) * ours(along_v->r);
    if (a == b) return Roughness{std::sqrt(a), 0};
    if (may_differ && a > 0 && b > 0) {
      const float rougher = std::max(a, b), ratio = std::min(a, b) / rougher;
      return Roughness{std::sqrt(std::min(1.0f, rougher * std::sqrt((1 + ratio * ratio) / 2))), 1 - ratio,
                       tangent_of_rougher(a, b)};
    }
    report_.warn(place, "roughness that differs along u and v is not supported here; its mean is used");
    return Roughness{std::sqrt(std::sqrt(a * b)), 0};
  }
  if (u != v)
    report_.warn(place, "roughness that differs along u and v is not supported here; that along u is used");
  const TexturePtr root = make_texture(PowerNode{u, exponent});
  if (!root) return report_.error(place, "a texture of the roughness refers to too many others");
  auto value = baker_.scalar(root, 1, place);
  if (!value) return fail(value.error());
  return Roughness{*value, 0};
}

RefractiveIndex Materials::refractive_index(const Parameters& p, std::string_view name, float otherwise) {
  const Parameter* parameter = p.find(name);
  if (parameter == nullptr) return {otherwise};
  RefractiveIndex read{otherwise};
  if (parameter->type == "texture") {
    report_.warn(p.place_of(parameter),
                 "a textured index of refraction is not supported; the default is used");
  } else {
    read = colors_.index(p, *parameter);
  }
  float& index = read.line_d;
  // 0 stands for 1 in files of pbrt.
  if (!(index >= 0 && index <= kMaxIor))
    p.remark(parameter->name, "range",
             fmt::format("must be from 0 to {:g}, got {:g}; {:g} is used", kMaxIor, index,
                         index > 0 ? kMaxIor : 1.0f));
  index = index > 0 ? std::min(index, kMaxIor) : 1;
  return read;
}

float Materials::index_of_refraction(const Parameters& p, std::string_view name, float otherwise) {
  const RefractiveIndex index = refractive_index(p, name, otherwise);
  if (index.dispersion.scale > 0)
    report_.warn(
        p.place_of(p.find(name)),
        "an index of refraction that depends on the wavelength is supported for dielectrics only; that "
        "of yellow light is used");
  return index.line_d;
}

Materials::Model Materials::diffuse(const Parameters& p, std::string_view reflectance) {
  if (p.number("sigma", 0) > 0)
    report_.warn(p.place(), "the roughness of diffuse reflection (sigma) is not supported; it is ignored");
  auto albedo = color(p, reflectance, Rgb::gray(0.5f));
  if (!albedo) return fail(albedo.error());
  return Lambert{*albedo};
}

Materials::Model Materials::coated_diffuse(const Parameters& p) {
  // Parameters of pbrt's own random walk, which converges to the same.
  p.find("maxdepth"), p.find("nsamples"), p.find("twosided");
  auto reflectance = color(p, "reflectance", Rgb::gray(0.5f));
  if (!reflectance) return fail(reflectance.error());
  auto rough = roughness(p, "", 0, false);
  if (!rough) return fail(rough.error());
  // Without scattering between the layers their distance has little effect.
  const Rgb albedo = colors_.color(p, "albedo", SpectrumRole::kAlbedo, {});
  for (const char* ignored : {"thickness", "g"})
    if (p.has(ignored)) p.remark(ignored, "has no effect, because nothing scatters between the layers");
  if (!is_black(albedo))
    report_.warn(p.place(), "scattering between the layers of a material is not supported; it is ignored");
  const float index = index_of_refraction(p, "eta", 1.5f);
  // pbrt takes a boundary without reflection for a smooth one.
  if (index == 1) return Lambert{*reflectance};
  Plastic plastic;
  plastic.diffuse = *reflectance;
  plastic.ior = index;
  plastic.roughness = rough->value;
  plastic.nonlinear = true;
  plastic.compensated = false;
  return plastic;
}

Materials::Model Materials::dielectric(const Parameters& p, std::string_view index) {
  auto rough = roughness(p, "", 0, false);
  if (!rough) return fail(rough.error());
  Glass glass;
  const auto [line_d, dispersion] = refractive_index(p, index, 1.5f);
  glass.ior = line_d;
  glass.dispersion = dispersion;
  if (dispersion.scale > 0)
    report_.warn(p.place_of(p.find(index)),
                 "an index of refraction that depends on the wavelength is approximated by Cauchy's formula "
                 "with two terms");
  glass.roughness = rough->value;
  return glass;
}

Materials::Model Materials::thin_dielectric(const Parameters& p) {
  ThinDielectric sheet;
  sheet.ior = index_of_refraction(p, "eta", 1.5f);
  report_.warn(p.place(), "crossings of the material 'thindielectric' do not count for \"maxdepth\"");
  return sheet;
}

Materials::Model Materials::diffuse_transmission(const Parameters& p) {
  auto reflected = color(p, "reflectance", Rgb::gray(0.25f));
  if (!reflected) return fail(reflected.error());
  auto transmitted = color(p, "transmittance", Rgb::gray(0.25f));
  if (!transmitted) return fail(transmitted.error());
  constexpr float kMaxScale = 1e6f;
  const float scale = p.number_in("scale", 1, 0, kMaxScale);
  for (ColorParameter* each : {&*reflected, &*transmitted}) {
    each->value = each->value * scale;
    if (max_component(each->value) <= 1) continue;
    p.remark("scale", "makes the surface brighter than white; its colour is clamped");
    each->value = {std::min(each->value.r, 1.0f), std::min(each->value.g, 1.0f),
                   std::min(each->value.b, 1.0f)};
  }
  const bool are_constant = reflected->texture < 0 && transmitted->texture < 0;
  if (are_constant && max_component(reflected->value + transmitted->value) > 1)
    p.remark("transmittance", "adds up to more than 1 with the reflectance; both are scaled down");
  return DiffuseTransmission{*reflected, *transmitted};
}

namespace {

// Of the parameters that tell what absorbs light in hair, the first counts, or else both kinds of melanin.
void remark_ineffective_pigments(const Parameters& p) {
  std::string_view counts;
  for (const std::string_view name : {"sigma_a", "reflectance", "color", "eumelanin", "pheomelanin"}) {
    if (!p.has(name)) continue;
    if (counts.empty())
      counts = name;
    else if (counts != "eumelanin")
      p.remark(name, fmt::format("is ignored, because '{}' is given", counts));
  }
}

}  // namespace

Materials::Model Materials::hair(const Parameters& p) {
  Hair hair;
  const bool has_melanin = p.has("eumelanin") || p.has("pheomelanin");
  // More makes no light visible.
  constexpr float kMaxMelanin = 1000, kMaxAbsorption = 100;
  auto eumelanin = scalar(p, "eumelanin", has_melanin ? 0.0f : 1.3f, kMaxMelanin);
  auto pheomelanin = scalar(p, "pheomelanin", 0, kMaxMelanin);
  auto beta_m = scalar(p, "beta_m", 0.3f, 1), beta_n = scalar(p, "beta_n", 0.3f, 1);
  for (const auto* read : {&eumelanin, &pheomelanin, &beta_m, &beta_n})
    if (!*read) return fail(read->error());
  hair.eumelanin = *eumelanin;
  hair.pheomelanin = *pheomelanin;
  hair.beta_m = *beta_m;
  hair.beta_n = *beta_n;
  hair.ior = index_of_refraction(p, "eta", 1.55f);
  hair.tilt_degrees = p.number_in("alpha", 2, -kMaxHairTiltDegrees, kMaxHairTiltDegrees);
  for (const char* name : {"color", "reflectance"}) {
    if (!p.has(name)) continue;
    auto given = color(p, name, Rgb::gray(0.5f));
    if (!given) return fail(given.error());
    hair.reflectance = *given;
    hair.pigment = HairPigment::kReflectance;
  }
  remark_ineffective_pigments(p);
  if (p.has("sigma_a")) {
    auto given = baker_.color(textures_.color(p, "sigma_a", SpectrumRole::kUnbounded, Rgb{}), kMaxAbsorption,
                              p.place_of(p.find("sigma_a")));
    if (!given) return fail(given.error());
    hair.sigma_a = *given;
    hair.pigment = HairPigment::kAbsorption;
  }
  return hair;
}

// Bump maps and normal maps.
Status Materials::add_relief(const Parameters& p, Material& material) {
  const char* name = p.has("displacement") ? "displacement" : "bumpmap";
  if (const TexturePtr height = textures_.number(p, name); height && constant_of(height) == nullptr) {
    auto texture = baker_.height(height, p.place_of(p.find(name)));
    if (!texture) return fail(texture.error());
    material.bump = {texture->texture, texture->value};
  }
  const std::string file = p.file_name("normalmap");
  if (file.empty()) return {};
  const Place place = p.place_of(p.find("normalmap"));
  const auto path = find_file(builder_, place, file);
  if (!path) {
    report_.warn(place, "missing image " + file,
                 fmt::format("the image {} does not exist; there is no normal map", in_quotes(file)));
    return {};
  }
  const auto texture = builder_.add_texture(*path, ImageUse{ColorSpace::kLinear, TextureChannel::kColor});
  if (texture) {
    material.normal_map.texture = *texture;
  } else if (texture.error().code == ErrorCode::kResourceExhausted) {
    return fail(texture.error());
  } else {
    report_.warn(place, "image " + file, texture.error().message + "; there is no normal map");
  }
  return {};
}

}  // namespace tessera::core::pbrt
