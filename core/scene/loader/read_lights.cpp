// SPDX-License-Identifier: Apache-2.0
// Reads delta lights and the environment of a scene file.
#include <fmt/format.h>

#include <cmath>

#include "core/geometry/placement.hpp"
#include "core/scene/loader/scene_file.hpp"
#include "core/scene/loader/table_reader.hpp"
#include "core/scene/tables/light_tables.hpp"
#include "core/scene/validation.hpp"

namespace tessera::core {
namespace {

using scene_keys::kLightTypes;

bool has_direction(Vec3 v) {
  return length_squared(v) > 0 && std::isfinite(length_squared(v));
}

// The identity after a mistake.
Transform read_orientation(const Field& field) {
  const std::size_t mistakes_before = field.mistakes().count();
  const TransformEntry steps = read_transform(field);
  if (field.mistakes().count() > mistakes_before) return {};
  if (!steps.motion.empty()) {
    field.mistake("an orientation cannot be animated");
    return {};
  }
  if (!(std::fabs(uniform_scale(steps.transform, kEnvironmentTolerance) - 1) <= kEnvironmentTolerance)) {
    field.mistake("the steps together must be a rotation or a reflection, which keep all lengths");
    return {};
  }
  return steps.transform;
}

// Of a texture of which only the image is used.
void check_whole_image(const Field& name, int index, const KnownNames& names, std::string_view user) {
  if (index < 0) return;
  const TextureEntry& texture = (*names.textures)[static_cast<std::size_t>(index)];
  if (texture.scale != Vec2{1, 1} || texture.offset != Vec2{0, 0} || texture.wrap != Wrap::kRepeat ||
      texture.wrap_v || texture.shear != Vec2{} || texture.uv_set != UvSet::kFirst ||
      texture.filter != TextureFilter::kLinear)
    name.mistake(
        fmt::format("{} is one whole image: leave out the texture's 'scale', 'offset', 'shear', "
                    "'uv_set', 'wrap' and 'filter'; {} turns it",
                    user, user == "the environment" ? "'rotation_degrees'" : "'orientation'"));
}

// What the table of a light does not tell. Relations between keys are checked only if there is no mistake
// yet.
void finish(const TableReader& read, PointLightDescription& light, const KnownNames& names, bool) {
  if (const auto texture = read.find("texture"))
    check_whole_image(*texture, light.texture, names, "the light's distribution");
  if (const auto orientation = read.find("orientation")) light.orientation = read_orientation(*orientation);
}

void check_edge(const std::optional<Field>& edge, Vec3 value) {
  if (edge && !has_direction(value))
    edge->mistake("must have a length that is greater than 0 and can be computed");
}

void finish(const TableReader& read, SpotLightDescription& light, const KnownNames&, bool is_sound) {
  if (!is_sound) return;
  if (const auto image = read.find("image")) {
    check_edge(find_member_field(*image, "right"), light.image.right);
    check_edge(find_member_field(*image, "up"), light.image.up);
  }
  if (!has_direction(light.look_at - light.position))
    read.field().mistake(
        "'look_at' must be another point than 'position', and not too near it to be computed");
}

void finish(const TableReader& read, DirectionalLightDescription& light, const KnownNames&, bool is_sound) {
  if (is_sound && !has_direction(light.direction))
    read.field().mistake("'direction' must have a length that is greater than 0 and can be computed");
}

bool is_animated(const LightAnimation& a) {
  return !(a.position.empty() && a.look_at.empty() && a.direction.empty() && a.color.empty() &&
           a.angle_degrees.empty() && a.softness.empty());
}

LightDescription read_light(const Field& field, std::size_t type, const KnownNames& names,
                            LightAnimation& animation) {
  const std::size_t mistakes_before = field.mistakes().count();
  const std::string kind = fmt::format("{} light", kLightTypes[type]);
  auto light = alternative<LightDescription>(type);
  std::visit(
      [&]<typename Light>(Light& description) {
        const TableReader read(field, kind, rules_of(kTypeKey, kKeys<Light>), names);
        read.read(kKeys<Light>, description, animation);
        finish(read, description, names, field.mistakes().count() == mistakes_before);
      },
      light);
  return light;
}

}  // namespace

std::vector<LightDescription> read_lights(const Field& field, const std::vector<TextureEntry>& textures,
                                          std::vector<LightAnimation>& animations) {
  const auto* items = field.value().get_if<JsonValue::Array>();
  if (items == nullptr) {
    field.must_be("a list of lights in brackets");
    return {};
  }
  const KnownNames names{.textures = &textures};
  std::vector<LightDescription> lights;
  for (std::size_t i = 0; i < items->size(); ++i) {
    const Field entry = field.element(i);
    const auto type = read_type(entry, kLightTypes, "light");
    if (!type) continue;
    LightAnimation animation{.light = static_cast<std::uint32_t>(lights.size())};
    lights.push_back(read_light(entry, *type, names, animation));
    if (is_animated(animation)) animations.push_back(std::move(animation));
  }
  return lights;
}

EnvironmentDescription read_environment(const Field& field, const std::vector<TextureEntry>& textures,
                                        ParameterTracks& tracks) {
  const KnownNames names{.textures = &textures};
  const TableReader read(field, "environment", rules_of(kKeys<EnvironmentDescription>), names);
  EnvironmentDescription environment;
  read.read(kKeys<EnvironmentDescription>, environment, tracks);
  if (const auto orientation = read.find("orientation"))
    environment.orientation = read_orientation(*orientation);
  if (const auto texture = read.find("texture"))
    check_whole_image(*texture, environment.radiance.texture, names, "the environment");
  return environment;
}

}  // namespace tessera::core
