// SPDX-License-Identifier: Apache-2.0
#include "core/scene/scene.hpp"

#include <utility>

#include "core/base/overloaded.hpp"
#include "core/scene/area_lights.hpp"
#include "core/scene/model.hpp"
#include "core/scene/validation.hpp"
#include "core/textures/opacity.hpp"

namespace tessera::core {
namespace {

Light make_light(const LightDescription& description) {
  return std::visit(
      Overloaded{
          [](const PointLightDescription& d) -> Light { return PointLight(d.position, d.intensity); },
          [](const SpotLightDescription& d) -> Light {
            return SpotLight(d.position, d.intensity,
                             {normalize(d.look_at - d.position), d.angle_degrees, d.softness});
          },
          [](const DirectionalLightDescription& d) -> Light {
            return DirectionalLight(normalize(d.direction), d.irradiance);
          },
      },
      description);
}

Environment make_environment(const EnvironmentDescription& d, const std::vector<Texture>& textures) {
  const int texture = d.radiance.texture;
  return {d.radiance.value, texture < 0 ? nullptr : textures[static_cast<std::size_t>(texture)].image,
          d.rotation_degrees};
}

// Replaces an opacity texture of a single texel (alpha that is 1 everywhere) by a number.
ScalarParameter without_constant_texture(const ScalarParameter& opacity,
                                         const std::vector<Texture>& textures) {
  if (opacity.texture < 0) return opacity;
  const TextureImage& image = *textures[static_cast<std::size_t>(opacity.texture)].image;
  return image.width() == 1 && image.height() == 1 ? opacity_at(opacity, textures, {}) : opacity;
}

}  // namespace

void Scene::add_materials(SceneDescription& description) {
  textures_ = std::move(description.textures);
  materials_ = std::move(description.materials);
  for (Material& material : materials_) {
    material.opacity = without_constant_texture(material.opacity, textures_);
    is_opaque_ &= core::is_opaque(material);
  }
}

void Scene::add_shapes(SceneDescription& description) {
  Model model = make_model(description.shapes);
  std::vector<Model> objects;
  for (ObjectDescription& object : description.objects) {
    objects.push_back(make_model(object.shapes));
    model.primitives.add_object(std::move(objects.back().primitives));
  }
  for (const auto& shape : description.shapes)
    if (const auto* instance = std::get_if<InstanceDescription>(&shape))
      model.primitives.add_instance(
          {Placement(instance->to_world), instance->object, instance->material.value_or(kOwnMaterials)});
  AreaLightFinder finder(materials_, textures_);
  finder.find(model, objects);
  lights_ = finder.take_lights();
  light_map_ = finder.take_map();
  primitives_ = std::move(model.primitives);
}

// Leaves out lights without power, which contribute nothing and could not be sampled.
void Scene::add_lights(const SceneDescription& description, int threads) {
  const double bounds = primitives_.bounding_radius(), radius = bounds > 0 ? bounds : 1;
  const auto has_power = [radius](const Light& light) { return power(light, radius) > 0; };
  for (const LightDescription& each : description.lights)
    if (const Light light = make_light(each); has_power(light)) lights_.push_back(light);
  if (description.environment) {
    Light environment = make_environment(*description.environment, textures_);
    if (has_power(environment)) {
      environment_light_ = static_cast<std::uint32_t>(lights_.size());
      lights_.push_back(std::move(environment));
    }
  }
  light_sampler_ = LightSampler(lights_, LightSampler::Among::kAll, threads);
  delta_light_sampler_ = LightSampler(lights_, LightSampler::Among::kDelta, threads);
}

Result<Scene> Scene::build(SceneDescription description, int threads, std::optional<Bvh> bvh) {
  if (auto ok = validate_scene(description); !ok) return fail(ok.error());

  Scene scene;
  scene.settings_ = description.settings;
  scene.camera_ = Camera(description.camera);
  scene.add_materials(description);
  scene.add_shapes(description);
  scene.add_lights(description, threads);
  scene.bvh_ = bvh ? std::move(*bvh) : Bvh::build(scene.primitives_, threads);
  return scene;
}

}  // namespace tessera::core
