// SPDX-License-Identifier: Apache-2.0
#include "core/scene/scene.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "core/base/overloaded.hpp"
#include "core/scene/absorbing_media.hpp"
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

std::optional<Light> environment_of(const SceneDescription& scene, const std::vector<Texture>& textures) {
  if (!scene.environment) return std::nullopt;
  const EnvironmentDescription& d = *scene.environment;
  const int texture = d.radiance.texture;
  return Environment(d.radiance.value,
                     texture < 0 ? nullptr : textures[static_cast<std::size_t>(texture)].image,
                     d.rotation_degrees, d.orientation, d.visible_to_camera);
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
    is_opaque_ &= core::is_opaque(material, materials_);
  }
}

void Scene::add_media(SceneDescription& description) {
  has_media_ = uses_media(description);
  if (!has_media_) return;
  const auto grids = std::make_shared<const std::vector<VoxelGrid>>(std::move(description.grids));
  for (const MediumDescription& medium : description.media) media_.emplace_back(medium, grids);
  camera_medium_ = description.camera_medium;
}

void Scene::add_shapes(SceneDescription& description) {
  Model model = make_model(description.shapes);
  quads_.own = std::move(model.quads);
  for (ObjectDescription& object : description.objects) {
    Model of_object = make_model(object.shapes);
    model.primitives.add_object(std::move(of_object.primitives));
    quads_.of_objects.push_back(std::move(of_object.quads));
  }
  for (const auto& shape : description.shapes)
    if (const auto* instance = std::get_if<InstanceDescription>(&shape))
      model.primitives.add_instance(
          {Placement(instance->to_world), instance->object, instance->material.value_or(kOwnMaterials)});
  primitives_ = std::move(model.primitives);
}

// Leaves out lights without power, which contribute nothing and could not be sampled.
void Scene::find_lights(const std::vector<LightDescription>& lights, std::optional<Light> environment,
                        int threads) {
  AreaLightFinder finder(materials_, textures_);
  finder.find(primitives_, quads_);
  lights_ = finder.take_lights();
  light_map_ = finder.take_map();
  const double bounds = primitives_.bounding_radius(), radius = bounds > 0 ? bounds : 1;
  const auto has_power = [radius](const Light& light) { return power(light, radius) > 0; };
  for (const LightDescription& each : lights)
    if (const Light light = make_light(each); has_power(light)) lights_.push_back(light);
  environment_light_ = kNoLight;
  if (environment && has_power(*environment)) {
    environment_light_ = static_cast<std::uint32_t>(lights_.size());
    lights_.push_back(*std::move(environment));
  }
  light_sampler_ = LightSampler(lights_, LightSampler::Among::kAll, threads);
  delta_light_sampler_ = LightSampler(lights_, LightSampler::Among::kDelta, threads);
}

Result<Scene> Scene::build(SceneDescription description, int threads, std::optional<Bvh> bvh) {
  if (auto ok = validate_scene(description); !ok) return fail(ok.error());

  Scene scene;
  scene.settings_ = description.settings;
  scene.poses_ = PoseMaker(description);
  scene.camera_ = Camera(description.camera);
  add_absorbing_media(description);
  scene.add_media(description);
  scene.add_materials(description);
  scene.add_shapes(description);
  scene.find_lights(description.lights, environment_of(description, scene.textures_), threads);
  scene.bvh_ = bvh ? std::move(*bvh) : Bvh::build(scene.primitives_, threads);
  return scene;
}

bool Scene::gives_light() const {
  return !lights_.empty() ||
         std::any_of(media_.begin(), media_.end(), [](const Medium& medium) { return medium.emits(); });
}

Status Scene::set_frame(std::int32_t frame, int threads) {
  if (!is_animated(animation()) || frame == frame_) {
    frame_ = frame;
    return {};
  }
  const Result<Pose> pose = poses_.at(frame);
  if (!pose) return fail(pose.error());
  const auto& moving = poses_.moving();
  for (std::size_t i = 0; i < moving.size(); ++i)
    primitives_.place_instance(moving[i].number, Placement(pose->placements[i]));
  if (!moving.empty()) bvh_.rebuild_own(primitives_, threads);
  if (!moving.empty() || !animation().lights.empty()) {
    std::optional<Light> environment;
    if (environment_light_ != kNoLight) environment = std::move(lights_[environment_light_]);
    find_lights(pose->lights, std::move(environment), threads);
  }
  camera_ = Camera(pose->camera);
  light_guide_ = {};
  frame_ = frame;
  return {};
}

}  // namespace tessera::core
