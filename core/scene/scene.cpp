#include "core/scene/scene.hpp"

#include <cmath>
#include <fmt/format.h>
#include <set>
#include <utility>

namespace tessera::core {
namespace {

template <typename... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};

tl::unexpected<Error> invalid(std::string message) { return fail(ErrorCode::kInvalidArgument, std::move(message)); }

bool fits(Vec3 p) {
  const auto in_range = [](float c) { return std::fabs(c) <= kMaxCoordinate; };
  return in_range(p.x) && in_range(p.y) && in_range(p.z);
}

Status check_camera(const CameraDescription& camera) {
  if (!fits(camera.position) || !fits(camera.look_at) || !is_finite(camera.up))
    return invalid("camera: position, look_at and up must be finite numbers");
  const Vec3 view = camera.look_at - camera.position;
  if (!(length_squared(view) > 0)) return invalid("camera.look_at: must differ from camera.position");
  const Vec3 across = cross(normalize(view), camera.up);
  if (!(length_squared(across) > 0)) return invalid("camera.up: must not be parallel to the viewing direction");
  if (!(camera.vertical_fov_degrees > 0 && camera.vertical_fov_degrees < 180))
    return invalid(fmt::format("camera.vertical_fov_degrees: must lie between 0 and 180, got {}", camera.vertical_fov_degrees));
  if (!(camera.aperture_radius >= 0) || !std::isfinite(camera.aperture_radius))
    return invalid(fmt::format("camera.aperture_radius: must be 0 or more, got {}", camera.aperture_radius));
  if (!(camera.focus_distance >= 0) || !std::isfinite(camera.focus_distance))
    return invalid(fmt::format("camera.focus_distance: must be above 0, got {}", camera.focus_distance));
  return {};
}

Status check_materials(const SceneDescription& scene) {
  const auto texture_count = static_cast<int>(scene.textures.size());
  const auto textures_exist = [&](const auto&... parameters) { return ((parameters.texture < texture_count) && ...); };
  for (const Material& material : scene.materials) {
    const bool ok = std::visit(
        Overloaded{
            [&](const Lambert& m) { return textures_exist(m.albedo); },
            [&](const Mirror& m) { return textures_exist(m.reflectance); },
            [&](const Glass& m) { return m.ior > 0 && textures_exist(m.reflectance, m.transmittance); },
        },
        material.model);
    if (!ok) return invalid(fmt::format("material '{}': a texture or the index of refraction is out of range", material.name));
    if (!is_finite(material.emission) || material.emission.r < 0 || material.emission.g < 0 || material.emission.b < 0)
      return invalid(fmt::format("material '{}': emission must be finite and not negative", material.name));
  }
  return {};
}

Status check_mesh(const MeshDescription& mesh, std::size_t material_count) {
  const std::size_t vertices = mesh.positions.size(), triangles = mesh.triangles.size();
  for (std::size_t i = 0; i < vertices; ++i)
    if (!fits(mesh.positions[i]))
      return invalid(fmt::format("vertex {}: coordinates must be numbers of at most {:g}", i + 1, kMaxCoordinate));
  if (!mesh.normals.empty() && mesh.normals.size() != vertices)
    return invalid(fmt::format("{} normals for {} vertices", mesh.normals.size(), vertices));
  if (!mesh.uvs.empty() && mesh.uvs.size() != vertices)
    return invalid(fmt::format("{} texture coordinates for {} vertices", mesh.uvs.size(), vertices));
  for (std::size_t i = 0; i < triangles; ++i)
    for (const std::uint32_t v : mesh.triangles[i])
      if (v >= vertices) return invalid(fmt::format("triangle {}: there is no vertex {}", i + 1, v + 1));
  if (mesh.triangle_materials.size() != 1 && mesh.triangle_materials.size() != triangles)
    return invalid(fmt::format("{} materials for {} triangles", mesh.triangle_materials.size(), triangles));
  for (const std::uint32_t m : mesh.triangle_materials)
    if (m >= material_count) return invalid(fmt::format("there is no material {}", m));
  return {};
}

Status check_shape(const ShapeDescription& shape, std::size_t material_count) {
  return std::visit(
      Overloaded{
          [&](const MeshDescription& mesh) { return check_mesh(mesh, material_count); },
          [&](const SphereDescription& s) -> Status {
            if (!fits(s.center) || !(s.radius > 0 && s.radius <= kMaxCoordinate))
              return invalid(fmt::format("the centre must be numbers of at most {:g} and the radius above 0", kMaxCoordinate));
            if (s.material >= material_count) return invalid(fmt::format("there is no material {}", s.material));
            return {};
          },
          [&](const QuadDescription& q) -> Status {
            if (!fits(q.corner) || !fits(q.edge_u) || !fits(q.edge_v))
              return invalid(fmt::format("coordinates must be numbers of at most {:g}", kMaxCoordinate));
            if (q.material >= material_count) return invalid(fmt::format("there is no material {}", q.material));
            return {};
          },
      },
      shape);
}

Status check_shapes(const SceneDescription& scene) {
  for (std::size_t i = 0; i < scene.shapes.size(); ++i) {
    if (auto ok = check_shape(scene.shapes[i], scene.materials.size()); !ok) {
      const bool named = i < scene.shape_names.size() && !scene.shape_names[i].empty();
      return fail(ok.error().within(named ? scene.shape_names[i] : fmt::format("shapes[{}]", i)));
    }
  }
  return {};
}

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
    primitives_.add_mesh({c, c + u, c + u + v, c + v}, {}, {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {{0, 1, 2}, {0, 2, 3}},
                         {quad.material});
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
      if (light.power() > 0) {
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
  if (auto ok = check_settings(description.settings); !ok) return fail(ok.error().within("render"));
  if (auto ok = check_camera(description.camera); !ok) return fail(ok.error());
  if (auto ok = check_materials(description); !ok) return fail(ok.error());
  if (auto ok = check_shapes(description); !ok) return fail(ok.error());

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
