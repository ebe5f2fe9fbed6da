// SPDX-License-Identifier: Apache-2.0
// Reads materials of a scene file.
#include <fmt/format.h>

#include <algorithm>

#include "core/scene/loader/scene_file.hpp"
#include "core/scene/loader/table_reader.hpp"
#include "core/scene/loader/wording.hpp"
#include "core/scene/tables/material_tables.hpp"

namespace tessera::core {
namespace {

using scene_keys::kMaterialTypes;

// The key, with its default if the file does not set it: 'specular'.
std::string name_with_default(const TableReader& read, std::string_view key, const ColorParameter& value) {
  return read.find(key) ? in_quotes(key) : fmt::format("{} ({} unless given)", in_quotes(key), value.value.r);
}

// Rejects surfaces that reflect more than they receive. Textures are clamped when they are evaluated.
void check_sum(const TableReader& read, const ColorParameter& diffuse, const ColorParameter& specular) {
  if (diffuse.texture >= 0 || specular.texture >= 0) return;
  const float sum = max_component(diffuse.value + specular.value);
  constexpr float kRounding = 1e-6f;
  if (sum > 1 + kRounding)
    read.field().mistake(fmt::format(
        "{} and {} add up to {:.6g}, and nothing reflects more than 1; lower one of them",
        name_with_default(read, "diffuse", diffuse), name_with_default(read, "specular", specular), sum));
}

using Above = std::vector<MaterialEntry>;

// What the table of a model does not tell: relations between keys, and keys without a member.
template <typename Model>
void finish(const TableReader&, Model&, const Above&) {}

void finish(const TableReader& read, Phong& model, const Above&) {
  check_sum(read, model.diffuse, model.specular);
}

void finish(const TableReader& read, CookTorrance& model, const Above&) {
  if (const auto metal = read.find("conductor"); metal && read.find("f0"))
    metal->mistake("a conductor has its own reflectance; leave 'f0' out, or this");
  check_sum(read, model.diffuse, model.specular);
}

void finish(const TableReader& read, ConductorMaterial& model, const Above&) {
  const auto metal = read.find("metal");
  if (!metal) return;
  const auto index = complex_index(static_cast<Conductor>(read_choice(*metal, scene_keys::kConductors)));
  model.eta = {index.eta, -1};
  model.k = {index.k, -1};
  if (read.find("eta") || read.find("k")) metal->mistake("a metal has its own 'eta' and 'k'; leave them out");
}

// What is given tells the pigment.
void finish(const TableReader& read, Hair& model, const Above&) {
  const auto reflectance = read.find("reflectance"), sigma_a = read.find("sigma_a");
  const bool has_melanin = read.find("eumelanin") || read.find("pheomelanin");
  if (sigma_a) model.pigment = HairPigment::kAbsorption;
  if (reflectance) model.pigment = HairPigment::kReflectance;
  if ((reflectance ? 1 : 0) + (sigma_a ? 1 : 0) + (has_melanin ? 1 : 0) > 1)
    (reflectance ? reflectance : sigma_a)
        ->mistake("hair has one of 'reflectance', 'sigma_a' and melanin; leave the others out");
}

// The index of a material above a blend.
std::uint32_t read_part(const Field& field, const std::vector<MaterialEntry>& above) {
  const std::string name = read_text(field);
  const auto found = std::find_if(above.begin(), above.end(),
                                  [&](const auto& entry) { return entry.material.name == name; });
  if (found != above.end()) return static_cast<std::uint32_t>(found - above.begin());
  std::vector<std::string_view> known;
  for (const auto& entry : above) known.push_back(entry.material.name);
  if (!name.empty())
    field.mistake(
        fmt::format("there is no material {} above this blend{}", in_quotes(name), suggestion(name, known)));
  return 0;
}

void finish(const TableReader& read, Blend& model, const Above& above) {
  const auto parts = read.find("materials");
  if (!parts) return;
  const auto* names = parts->value().get_if<JsonValue::Array>();
  if (names == nullptr || names->size() != 2) {
    parts->must_be("a list of 2 names of materials");
    return;
  }
  model.first = read_part(parts->element(0), above);
  model.second = read_part(parts->element(1), above);
}

// Keyframes are added to `tracks`.
Material read_material(const Field& field, const std::string& name, const KnownNames& names,
                       const Above& above, ParameterTracks& tracks) {
  const auto type = read_type(field, kMaterialTypes, "material");
  if (!type) return {name, Lambert{}};
  Material material{name, alternative<MaterialModel>(*type)};
  const std::string kind = fmt::format("{} material", kMaterialTypes[*type]);
  std::visit(
      [&]<typename Model>(Model& model) {
        const TableReader read(field, kind, rules_of(kTypeKey, kKeys<Model>, kCommonKeys<Model>), names);
        read.read(kKeys<Model>, model, tracks);
        read.read(kCommonKeys<Model>, material, tracks);
        finish(read, model, above);
      },
      material.model);
  return material;
}

}  // namespace

std::vector<MaterialEntry> read_materials(const Field& field, const std::vector<TextureEntry>& textures,
                                          const std::vector<MediumDescription>& media) {
  std::vector<MaterialEntry> materials;
  for (const auto& [name, entry] : read_named(field)) {
    ParameterTracks tracks;
    Material material =
        read_material(entry, name, {.textures = &textures, .media = &media}, materials, tracks);
    materials.push_back({std::move(material), entry.place(), std::move(tracks)});
  }
  return materials;
}

}  // namespace tessera::core
