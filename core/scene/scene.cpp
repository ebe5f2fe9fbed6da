#include "core/scene/scene.hpp"

#include <cmath>
#include <utility>

#include "core/scene/validation.hpp"

namespace tessera::core {
namespace {

// Turns shapes into primitives and emissive shapes into lights. Triangles are numbered before spheres.
class Assembler {
 public:
  explicit Assembler(const std::vector<Material>& materials) : materials_(materials) {}

  void add(const MeshDescription& mesh) {
    const std::uint32_t first = primitives_.triangle_count();
    primitives_.add_mesh(mesh.positions, mesh.normals, mesh.uvs, mesh.triangles, mesh.triangle_materials);
    for (std::uint32_t p = first; p < primitives_.triangle_count(); ++p) {
      const auto [p0, p1, p2] = primitives_.triangle_corners(p);
      add_light(TriangleLight{p0, p1, p2}, p, 1);
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
  void add_light(LightShape shape, std::uint32_t first, std::uint32_t primitive_count) {
    const Material& material = materials_[primitives_.material(first)];
    std::uint32_t id = kNoLight;
    if (!is_black(material.emission)) {
      const Light light(shape, front_of(first), material.emission, material.two_sided_emission);
      if (light.power() > 0 && std::isfinite(light.power())) {
        id = static_cast<std::uint32_t>(lights_.size());
        lights_.push_back(light);
      }
    }
    light_of_primitive_.insert(light_of_primitive_.end(), primitive_count, id);
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
};

}  // namespace

Result<Scene> Scene::build(SceneDescription description, int threads) {
  if (auto ok = validate_scene(description); !ok) return fail(ok.error());

  Scene scene;
  scene.settings_ = description.settings;
  scene.camera_ = Camera(description.camera);
  scene.textures_ = std::move(description.textures);
  scene.materials_ = std::move(description.materials);

  Assembler assembler(scene.materials_);
  for (auto& shape : description.shapes) {
    if (auto* mesh = std::get_if<MeshDescription>(&shape)) {
      assembler.add(*mesh);
      *mesh = {};  // gives its memory back before the next is copied
    } else if (const auto* quad = std::get_if<QuadDescription>(&shape)) {
      assembler.add(*quad);
    }
  }
  for (const auto& shape : description.shapes)
    if (const auto* sphere = std::get_if<SphereDescription>(&shape)) assembler.add(*sphere);

  scene.primitives_ = std::move(assembler.primitives_);
  scene.lights_ = std::move(assembler.lights_);
  scene.light_of_primitive_ = std::move(assembler.light_of_primitive_);
  scene.light_sampler_ = LightSampler(scene.lights_);
  scene.bvh_ = Bvh::build(scene.primitives_, threads);
  return scene;
}

}  // namespace tessera::core
