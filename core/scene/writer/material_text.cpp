// SPDX-License-Identifier: Apache-2.0
#include "core/scene/writer/material_text.hpp"

#include <cstddef>
#include <map>
#include <variant>

#include "core/scene/loader/scene_keys.hpp"
#include "core/scene/writer/motion_text.hpp"

namespace tessera::core {
namespace {

using json_text::Object;

std::string number_text(float value) {
  return json_text::number(value);
}

std::string texture_name(int texture, const SceneNames& names) {
  return json_text::text(names.textures[static_cast<std::size_t>(texture)]);
}

template <typename Words, typename Enum>
std::string word(const Words& words, Enum value) {
  return json_text::text(words[static_cast<std::size_t>(value)]);
}

// The texts of the parameters that a model has by default.
template <typename Model>
std::map<std::string_view, std::string> default_texts(const SceneNames& names) {
  std::map<std::string_view, std::string> texts;
  visit_parameters(Model(), [&](std::string_view key, const auto& parameter) {
    texts[key] = parameter_text(parameter, names);
  });
  return texts;
}

// What a model has besides its parameters.
template <typename Model>
void add_choices(const Model&, const SceneNames&, Object&) {}

void add_microfacets(MicrofacetKind kind, Object& object) {
  object.add_unless(word(scene_keys::kDistributions, MicrofacetKind().distribution), "distribution",
                    word(scene_keys::kDistributions, kind.distribution));
  object.add_unless(word(scene_keys::kSmithMaskings, MicrofacetKind().masking), "masking",
                    word(scene_keys::kSmithMaskings, kind.masking));
}

void add_choices(const Glass& model, const SceneNames&, Object& object) {
  add_microfacets(model.microfacets, object);
  object.add_unless(word(scene_keys::kDielectricFresnels, Glass().fresnel), "fresnel",
                    word(scene_keys::kDielectricFresnels, model.fresnel));
}

void add_choices(const Phong& model, const SceneNames&, Object& object) {
  object.add_unless(word(scene_keys::kPhongLobes, Phong().lobe), "lobe",
                    word(scene_keys::kPhongLobes, model.lobe));
}

void add_choices(const CookTorrance& model, const SceneNames&, Object& object) {
  if (model.conductor) object.add("conductor", word(scene_keys::kConductors, *model.conductor));
  object.add_unless(word(scene_keys::kMaskings, CookTorrance().masking), "masking",
                    word(scene_keys::kMaskings, model.masking));
}

void add_choices(const Principled& model, const SceneNames&, Object& object) {
  object.add_unless(json_text::boolean(false), "geometry_thin_walled",
                    json_text::boolean(model.geometry_thin_walled));
}

void add_choices(const Plastic& model, const SceneNames&, Object& object) {
  object.add_unless(json_text::boolean(false), "nonlinear", json_text::boolean(model.nonlinear));
  add_microfacets(model.microfacets, object);
  object.add_unless(json_text::boolean(true), "compensated", json_text::boolean(model.compensated));
}

void add_choices(const ConductorMaterial& model, const SceneNames&, Object& object) {
  add_microfacets(model.microfacets, object);
}

void add_choices(const Hair& model, const SceneNames&, Object& object) {
  object.add_unless(json_text::number(Hair{}.tilt_degrees), "tilt_degrees",
                    json_text::number(model.tilt_degrees));
}

void add_choices(const Blend& model, const SceneNames& names, Object& object) {
  object.add("materials", json_text::list({json_text::text(names.materials[model.first]),
                                           json_text::text(names.materials[model.second])}));
}

// A metal has its own reflectance.
template <typename Model>
bool is_written(const Model&, std::string_view) {
  return true;
}
bool is_written(const CookTorrance& model, std::string_view key) {
  return !(model.conductor && key == "f0");
}
// The pigment is told by its parameter, whatever its value.
bool is_written(const Hair& model, std::string_view key) {
  if (key == "reflectance") return model.pigment == HairPigment::kReflectance;
  if (key == "sigma_a") return model.pigment == HairPigment::kAbsorption;
  return !key.ends_with("melanin") || model.pigment == HairPigment::kMelanin;
}
template <typename Model>
bool is_always_written(const Model&, std::string_view) {
  return false;
}
bool is_always_written(const Hair&, std::string_view key) {
  return key == "reflectance" || key == "sigma_a";
}

const Track<Rgb>& track_of(const ParameterTracks& tracks, std::string_view key, const ColorParameter&) {
  return color_track(tracks, key);
}
const Track<float>& track_of(const ParameterTracks& tracks, std::string_view key, const ScalarParameter&) {
  return number_track(tracks, key);
}

void add_model(const MaterialModel& material, const SceneNames& names, const ParameterTracks& tracks,
               Object& object) {
  std::visit(
      [&]<typename Model>(const Model& model) {
        const auto defaults = default_texts<Model>(names);
        visit_parameters(model, [&](std::string_view key, const auto& parameter) {
          if (!is_written(model, key)) return;
          const std::string otherwise = is_always_written(model, key) ? "" : defaults.at(key);
          object.add_unless(otherwise, key,
                            parameter_text(parameter, names, track_of(tracks, key, parameter)));
        });
        add_choices(model, names, object);
      },
      material);
}

// A texture with the key and the value of its factor.
std::string map_text(int texture, std::string_view factor, float value, const SceneNames& names,
                     const Track<float>& track) {
  Object map;
  map.add("texture", texture_name(texture, names));
  map.add_unless(json_text::number(1.0f), factor, animated_text(value, track, number_text));
  return map.on_one_line();
}

}  // namespace

std::string parameter_text(const ColorParameter& parameter, const SceneNames& names,
                           const Track<Rgb>& track) {
  const std::string value =
      animated_text(parameter.value, track, [](Rgb color) { return json_text::color(color); });
  if (parameter.texture < 0) return value;
  Object object;
  object.add("texture", texture_name(parameter.texture, names));
  object.add_unless(json_text::number(1.0f), "tint", value);
  return object.on_one_line();
}

std::string parameter_text(const ScalarParameter& parameter, const SceneNames& names,
                           const Track<float>& track) {
  if (parameter.texture < 0) return animated_text(parameter.value, track, number_text);
  return map_text(parameter.texture, "scale", parameter.value, names, track);
}

std::string material_text(const Material& material, const SceneNames& names, const ParameterTracks& tracks) {
  const Material standard;
  Object object;
  object.add("type", json_text::text(scene_keys::kMaterialTypes[material.model.index()]));
  add_model(material.model, names, tracks, object);
  object.add_unless(
      parameter_text(standard.emission, names), "emission",
      parameter_text(material.emission, names, track_of(tracks, "emission", material.emission)));
  if (!material.two_sided_emission) object.add("emission_sides", json_text::text("front"));
  object.add_unless(word(scene_keys::kMicrofacetSamplings, standard.sampling), "sampling",
                    word(scene_keys::kMicrofacetSamplings, material.sampling));
  if (material.normal_map.texture >= 0)
    object.add("normal_map", map_text(material.normal_map.texture, "strength", material.normal_map.strength,
                                      names, number_track(tracks, "normal_map")));
  if (material.bump.texture >= 0)
    object.add("bump", map_text(material.bump.texture, "height", material.bump.height, names,
                                number_track(tracks, "bump")));
  object.add_unless(parameter_text(standard.opacity, names), "opacity",
                    parameter_text(material.opacity, names, track_of(tracks, "opacity", material.opacity)));
  const bool has_sides =
      !std::holds_alternative<Blend>(material.model) && !std::holds_alternative<Null>(material.model);
  if (has_sides && !material.two_sided) object.add("sides", json_text::text("front"));
  const auto add_medium = [&](std::string_view key, int medium) {
    if (medium >= 0) object.add(key, json_text::text(names.media[static_cast<std::size_t>(medium)]));
  };
  add_medium("interior_medium", material.media.interior);
  add_medium("exterior_medium", material.media.exterior);
  return object.on_one_line();
}

}  // namespace tessera::core
