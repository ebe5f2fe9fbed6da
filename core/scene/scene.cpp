// SPDX-License-Identifier: Apache-2.0
#include "core/scene/scene.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "core/base/overloaded.hpp"
#include "core/math/lane_array.hpp"
#include "core/scene/absorbing_media.hpp"
#include "core/scene/area_lights.hpp"
#include "core/scene/model.hpp"
#include "core/scene/validation.hpp"
#include "core/textures/opacity.hpp"

namespace tessera::core {
namespace {

lights::Light make_light(const LightDescription& description, const std::vector<Texture>& textures) {
  const auto image_of = [&](int texture) -> std::shared_ptr<const TextureImage> {
    return texture < 0 ? nullptr : textures[static_cast<std::size_t>(texture)].image;
  };
  return std::visit(Overloaded{
                        [&](const PointLightDescription& d) -> lights::Light {
                          return lights::PointLight(d.position, d.intensity, image_of(d.texture),
                                                    d.orientation);
                        },
                        [&](const SpotLightDescription& d) -> lights::Light {
                          const auto image = image_of(d.image.texture);
                          return lights::SpotLight(
                              d.position, d.intensity,
                              {normalize(d.look_at - d.position), d.angle_degrees, d.softness, d.falloff},
                              d.image, image ? image->mean() : Rgb::gray(1));
                        },
                        [](const DirectionalLightDescription& d) -> lights::Light {
                          return lights::DirectionalLight(normalize(d.direction), d.irradiance);
                        },
                    },
                    description);
}

std::optional<lights::Light> environment_of(const std::optional<EnvironmentDescription>& environment,
                                            const std::vector<Texture>& textures) {
  if (!environment) return std::nullopt;
  const EnvironmentDescription& d = *environment;
  const int texture = d.radiance.texture;
  return lights::Environment(d.radiance.value,
                             texture < 0 ? nullptr : textures[static_cast<std::size_t>(texture)].image,
                             d.rotation_degrees, d.orientation, d.visible_to_camera);
}

// Whether lights change without any motion: materials may emit.
bool changes_lights(const Animation& animation) {
  return !animation.lights.empty() || !animation.materials.empty() || !animation.environment.empty();
}

// Replaces an opacity by an image of a single texel (alpha that is 1 everywhere) by a number.
ScalarParameter without_constant_texture(const ScalarParameter& opacity,
                                         const std::vector<Texture>& textures) {
  const TextureImage* image = image_of_opacity(opacity, textures);
  const bool is_constant = image != nullptr && image->width() == 1 && image->height() == 1;
  return is_constant ? opacity_at(opacity, textures, {}) : opacity;
}

}  // namespace

void Scene::set_materials(std::vector<Material> materials, std::vector<MediumDescription> media) {
  add_absorbing_media(materials, media);
  has_media_ = uses_media(camera_medium_, materials);
  media_.clear();
  if (has_media_)
    for (const MediumDescription& medium : media) media_.emplace_back(medium, grids_);
  nested_dielectrics_ = NestedDielectrics(materials);
  is_opaque_ = nested_dielectrics_.empty();
  has_dispersion_ = hides_surfaces_ = false;
  materials_ = std::move(materials);
  for (Material& material : materials_) {
    material.opacity = without_constant_texture(material.opacity, textures_);
    has_dispersion_ |= disperses(material.model);
    hides_surfaces_ |= !material.visible_to_camera;
    is_opaque_ &= core::is_opaque(material, materials_) && material.visible_to_camera;
  }
  opacities_ = opacities_of(materials_, textures_, nested_dielectrics_);
}

void Scene::mark_opacities(int threads) {
  const bool any =
      std::ranges::any_of(opacities_, [](auto o) { return o != accel::MaterialOpacity::kOpaque; });
  if (any || has_opacities_) bvh_.set_opacities(primitives_, opacities_, threads);
  has_opacities_ = any;
}

namespace {

bool follows_tangents(const Material& material) {
  return material.normal_map.texture >= 0 || highlight_direction(material.model) != nullptr ||
         with_own_coat_frame(material.model) != nullptr;
}

// Calls what(mesh) for all meshes, also those of objects.
template <typename What>
void for_each_mesh(SceneDescription& scene, const What& what) {
  const auto visit_all = [&](std::vector<ShapeDescription>& shapes) {
    for (ShapeDescription& shape : shapes)
      if (auto* mesh = std::get_if<MeshDescription>(&shape)) what(*mesh);
  };
  visit_all(scene.shapes);
  for (ObjectDescription& object : scene.objects) visit_all(object.shapes);
}

}  // namespace

// What takes memory and time, and no material uses.
void Scene::drop_unused_attributes(SceneDescription& description) const {
  if (std::ranges::none_of(textures_, [](const Texture& t) { return t.uv_set == UvSet::kSecond; }))
    for_each_mesh(description, [](MeshDescription& mesh) { mesh.second_uvs = std::vector<Vec2>(); });
  if (animation().materials.empty() && std::ranges::none_of(materials_, follows_tangents))
    for_each_mesh(description, [](MeshDescription& mesh) {
      mesh.tangents = std::vector<VertexTangent>();
      for (MeshStep& step : mesh.steps) step.tangents = std::vector<VertexTangent>();
    });
}

void Scene::add_shapes(SceneDescription& description) {
  drop_unused_attributes(description);
  Model model = make_model(description.shapes);
  ids_.set_starts(std::move(model.starts));
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

Camera Scene::moving_camera(float time) const {
  return Camera(poses_.camera_at(shutter_.at(time)));
}

RayOf<FloatN> Scene::moving_camera_rays(Vec2Of<FloatN> raster, int width_px, int height_px,
                                        Vec2Of<FloatN> u_lens, FloatN time) const {
  const FloatLanes x(raster.x), y(raster.y), u(u_lens.x), v(u_lens.y), times(time);
  Vec3Lanes origins, directions;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    const Ray ray =
        moving_camera(times[lane]).ray({x[lane], y[lane]}, width_px, height_px, {u[lane], v[lane]});
    origins.set(lane, ray.origin), directions.set(lane, ray.direction);
  }
  return {origins.all(), directions.all()};
}

void Scene::open_shutter() {
  shutter_ = poses_.shutter(frame_);
  camera_moves_ = !shutter_.empty() && is_animated(animation().camera);
  const auto frame = static_cast<float>(frame_);
  const float shown = shutter_.empty() ? shutter_.begin : frame;
  camera_ = Camera(poses_.camera_at(shown));
  if (animation().deforms) primitives_.deform(shown, shutter_);
  const FrameInterval until_open{std::min(frame, shutter_.begin), std::max(frame, shutter_.begin)};
  const auto& motions = animation().instances;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const std::vector<MotionStep>& steps = motions[i].steps;
    const std::uint32_t number = poses_.moving()[i].number;
    if (moves(steps, shutter_))
      primitives_.move_instance(number, MovingPlacement(steps, shutter_));
    else if (moves(steps, until_open))
      primitives_.place_instance(number, Placement(transform_at(steps, shutter_.begin)));
  }
}

// Leaves out lights without power, which contribute nothing and could not be sampled.
void Scene::find_lights(const std::vector<LightDescription>& lights,
                        std::optional<lights::Light> environment) {
  AreaLightFinder finder(materials_, textures_);
  finder.find(primitives_, quads_);
  groups_of_lights_.clear();
  for (const std::uint32_t material : finder.materials()) add_group(materials_[material].light_group);
  lights_ = finder.take_lights();
  light_map_ = finder.take_map();
  const double bounds = primitives_.bounding_radius(), radius = bounds > 0 ? bounds : 1;
  const auto has_power = [radius](const lights::Light& light) { return power(light, radius) > 0; };
  for (const LightDescription& each : lights)
    if (const lights::Light light = make_light(each, textures_); has_power(light)) {
      lights_.push_back(light);
      add_group(light_group_of(each));
    }
  environment_light_ = lights::kNoLight;
  if (environment && has_power(*environment)) {
    environment_light_ = static_cast<std::uint32_t>(lights_.size());
    lights_.push_back(*std::move(environment));
    add_group(environment_group_);
  }
}

Result<Scene> Scene::build(SceneDescription description, int threads, std::optional<accel::Bvh> bvh) {
  if (auto ok = validate_scene(description); !ok) return fail(ok.error());

  Scene scene;
  auto settings = resolve_settings(description, {});
  if (!settings) return fail(settings.error());
  scene.settings_ = *std::move(settings);
  scene.light_groups_ = core::light_groups(description);
  if (description.environment) scene.environment_group_ = description.environment->light_group;
  scene.poses_ = PoseMaker(description);
  if (auto ok = scene.poses_.check_while_open(0); !ok) return fail(ok.error());
  scene.ids_ = SceneIds(description);
  scene.textures_ = std::move(description.textures);
  scene.grids_ = std::make_shared<const std::vector<VoxelGrid>>(std::move(description.grids));
  scene.camera_medium_ = description.camera_medium;
  scene.set_materials(std::move(description.materials), std::move(description.media));
  scene.add_shapes(description);
  scene.open_shutter();
  scene.find_lights(description.lights, environment_of(description.environment, scene.textures_));
  scene.bvh_ = bvh ? std::move(*bvh) : accel::Bvh::build(scene.primitives_, threads);
  scene.mark_opacities(threads);
  return scene;
}

bool Scene::gives_light() const {
  return !lights_.empty() ||
         std::any_of(media_.begin(), media_.end(), [](const Medium& medium) { return medium.emits(); });
}

std::optional<lights::Light> Scene::environment_at(const Pose& pose) {
  if (!animation().environment.empty()) return environment_of(pose.environment, textures_);
  if (environment_light_ == lights::kNoLight) return std::nullopt;
  return std::move(lights_[environment_light_]);
}

Status Scene::set_frame(std::int32_t frame, int threads) {
  if (!is_animated(animation()) || frame == frame_) {
    frame_ = frame;
    return {};
  }
  const Result<Pose> pose = poses_.at(frame);
  if (!pose) return fail(pose.error());
  const auto& moving = poses_.moving();
  frame_ = frame;
  ++revision_;
  primitives_.stop_instances();
  for (std::size_t i = 0; i < moving.size(); ++i)
    primitives_.place_instance(moving[i].number, Placement(pose->placements[i]));
  open_shutter();
  const bool shapes_move = !moving.empty() || animation().deforms;
  if (shapes_move) bvh_.rebuild(primitives_, threads);
  if (animation().changes_materials()) set_materials(pose->materials, pose->media);
  if (shapes_move || animation().changes_materials()) mark_opacities(threads);
  if (shapes_move || changes_lights(animation())) find_lights(pose->lights, environment_at(*pose));
  return {};
}

}  // namespace tessera::core
