#include "core/scene/scene.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/overloaded.hpp"
#include "core/scene/validation.hpp"

namespace tessera::core {
namespace {

// Turns shapes into primitives and emissive shapes into lights. Triangles are numbered before spheres.
class Assembler {
 public:
  Assembler(const std::vector<Material>& materials, const std::vector<Texture>& textures)
      : materials_(materials) {
    for (const Material& material : materials) mean_radiances_.push_back(mean_radiance(material, textures));
  }

  // Many meshes are copied into arrays that are large enough; a single one is not copied.
  void reserve(const std::vector<ShapeDescription>& shapes) {
    std::size_t meshes = 0, vertices = 0, triangles = 0;
    for (const ShapeDescription& shape : shapes)
      if (const auto* mesh = std::get_if<MeshDescription>(&shape)) {
        ++meshes;
        vertices += mesh->positions.size();
        triangles += mesh->triangles.size();
      }
    if (meshes > 1) primitives_.reserve(vertices, triangles);
  }

  // Takes the mesh's memory over or gives it back, before the next is added.
  void add(MeshDescription mesh) {
    const std::uint32_t first = primitives_.triangle_count();
    const bool shines = std::any_of(mesh.triangle_materials.begin(), mesh.triangle_materials.end(),
                                    [&](std::uint32_t m) { return mean_radiances_[m] > 0; });
    primitives_.add_mesh(std::move(mesh.positions), mesh.normals, mesh.uvs, std::move(mesh.triangles),
                         mesh.triangle_materials);
    if (!shines) return;
    for (std::uint32_t p = first; p < primitives_.triangle_count(); ++p) {
      const auto [p0, p1, p2] = primitives_.triangle_corners(p);
      const auto [uv0, uv1, uv2] = primitives_.triangle_uvs(p);
      add_light(TriangleLight{p0, p1, p2, uv0, uv1, uv2}, p, 1);
    }
  }

  void add(const QuadDescription& quad) {
    const std::uint32_t first = primitives_.triangle_count();
    const Vec3 c = quad.corner, u = quad.edge_u, v = quad.edge_v;
    primitives_.add_mesh({c, c + u, c + u + v, c + v}, {}, {{0, 0}, {1, 0}, {1, 1}, {0, 1}},
                         {{0, 1, 2}, {0, 2, 3}}, {quad.material});
    add_light(QuadLight{c, u, v}, first, 2);
  }

  void add(const SphereDescription& sphere) {
    const std::uint32_t first = primitives_.count();
    primitives_.add_sphere(sphere.center, sphere.radius, sphere.material);
    add_light(SphereLight{sphere.center, sphere.radius}, first, 1);
  }

  Primitives primitives_;
  std::vector<Light> lights_;
  std::vector<std::uint32_t> light_of_primitive_;

 private:
  static double mean_radiance(const Material& material, const std::vector<Texture>& textures) {
    const ColorParameter& emission = material.emission;
    if (emission.texture < 0 || is_black(emission.value)) return static_cast<double>(mean(emission.value));
    const Texture& texture = textures[static_cast<std::size_t>(emission.texture)];
    return static_cast<double>(mean(emission.value * texture.image->mean()));
  }

  void add_light(LightShape shape, std::uint32_t first, std::uint32_t primitive_count) {
    const std::uint32_t material_id = primitives_.material(first);
    const Material& material = materials_[material_id];
    if (!(mean_radiances_[material_id] > 0)) return;
    const AreaLight light(shape, front_of(first),
                          {material.emission, mean_radiances_[material_id], material.two_sided_emission});
    if (!(light.power() > 0 && std::isfinite(light.power()))) return;
    light_of_primitive_.resize(first, kNoLight);
    light_of_primitive_.resize(first + primitive_count, static_cast<std::uint32_t>(lights_.size()));
    lights_.push_back(light);
  }

  // The outward normal in the middle of a primitive.
  Vec3 front_of(std::uint32_t primitive) const {
    Hit middle;
    middle.primitive = primitive;
    middle.t = 1;
    middle.b1 = middle.b2 = 1.0f / 3;
    return primitives_.is_sphere(primitive) ? Vec3{} : primitives_.surface(Ray{}, middle).geometric_normal;
  }

  const std::vector<Material>& materials_;
  std::vector<double> mean_radiances_;  // of each material's emission
};

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

}  // namespace

// Lights without power are left out: they shine on nothing, and chance could not find them.
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
  scene.textures_ = std::move(description.textures);
  scene.materials_ = std::move(description.materials);

  Assembler assembler(scene.materials_, scene.textures_);
  assembler.reserve(description.shapes);
  for (auto& shape : description.shapes) {
    if (auto* mesh = std::get_if<MeshDescription>(&shape)) {
      assembler.add(std::move(*mesh));
    } else if (const auto* quad = std::get_if<QuadDescription>(&shape)) {
      assembler.add(*quad);
    }
  }
  for (const auto& shape : description.shapes)
    if (const auto* sphere = std::get_if<SphereDescription>(&shape)) assembler.add(*sphere);

  scene.primitives_ = std::move(assembler.primitives_);
  scene.lights_ = std::move(assembler.lights_);
  scene.light_of_primitive_ = std::move(assembler.light_of_primitive_);
  scene.add_lights(description, threads);
  scene.bvh_ = bvh ? std::move(*bvh) : Bvh::build(scene.primitives_, threads);
  return scene;
}

}  // namespace tessera::core
