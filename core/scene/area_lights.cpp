// SPDX-License-Identifier: Apache-2.0
#include "core/scene/area_lights.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>

namespace tessera::core {
namespace {

// The means of textures, each computed once: many materials may share one.
class TextureMeans {
 public:
  explicit TextureMeans(const std::vector<Texture>& textures)
      : textures_(textures), means_(textures.size()) {}

  Rgb of(int texture) {
    const auto i = static_cast<std::size_t>(texture);
    if (!means_[i]) means_[i] = textures_[i].mean(textures_);
    return *means_[i];
  }

 private:
  const std::vector<Texture>& textures_;
  std::vector<std::optional<Rgb>> means_;
};

double mean_opacity(const Material& material, TextureMeans& means) {
  const ScalarParameter& opacity = material.opacity;
  if (opacity.texture < 0) return static_cast<double>(opacity.value);
  return std::clamp(static_cast<double>(opacity.value * means.of(opacity.texture).r), 0.0, 1.0);
}

// The mean radiance that leaves the surface, including opacity.
double mean_radiance(const Material& material, TextureMeans& means) {
  const ColorParameter& emission = material.emission;
  if (is_black(emission.value)) return 0;
  const double opacity = mean_opacity(material, means);
  if (emission.texture < 0) return static_cast<double>(mean(emission.value)) * opacity;
  return static_cast<double>(mean(emission.value * means.of(emission.texture))) * opacity;
}

lights::CylinderLight cylinder_light(const Cylinder& cylinder) {
  const Transform t = cylinder.transform();
  return {t.origin, t.z_axis, t.x_axis, t.y_axis, cylinder.flipped()};
}

lights::TriangleLight triangle_light(const Primitives& primitives, std::uint32_t p, bool is_textured) {
  const auto [p0, p1, p2] = primitives.triangle_corners(p);
  if (!is_textured) return {p0, p1, p2};
  const auto first = primitives.triangle_uvs(p), second = primitives.triangle_uvs(p, UvSet::kSecond);
  std::array<UvSets, 3> uvs;
  for (std::size_t corner = 0; corner < 3; ++corner) uvs[corner] = UvSets(first[corner], second[corner]);
  return {p0, p1, p2, std::make_shared<const std::array<UvSets, 3>>(uvs)};
}

// `is_textured`: whether its radiance or opacity has a texture.
lights::LightShape shape_of(const Primitives& primitives, std::uint32_t p, bool is_textured) {
  if (primitives.is_sphere(p))
    return lights::SphereLight{primitives.sphere(p).center, primitives.sphere(p).radius};
  if (primitives.is_disk(p)) {
    const Disk& d = primitives.disk(p);
    return lights::DiskLight{d.center, d.radius_u, d.radius_v, d.inner};
  }
  if (primitives.is_cylinder(p)) return cylinder_light(primitives.cylinder(p));
  return triangle_light(primitives, p, is_textured);
}

// Calls add(first primitive, quad or null) for all triangles, quads and other shapes for which
// emissive(primitive), and records the returned light index for each primitive of the shape, up to the last
// emissive one.
template <typename Emissive, typename Add>
std::vector<std::uint32_t> for_each_light_shape(const Primitives& primitives,
                                                const std::vector<Model::Quad>& quads,
                                                const Emissive& emissive, const Add& add) {
  const std::uint32_t count = primitives.shape_count();
  std::vector<std::uint32_t> lights;
  auto quad = quads.begin();
  for (std::uint32_t p = 0, size; p < count; p += size) {
    const bool is_quad = quad != quads.end() && quad->first == p;
    size = is_quad ? 2 : 1;
    const std::uint32_t light = emissive(p) ? add(p, is_quad ? &quad->shape : nullptr) : lights::kNoLight;
    if (is_quad) ++quad;
    if (light == lights::kNoLight) continue;
    lights.resize(p, lights::kNoLight);
    lights.resize(p + size, light);
  }
  return lights;
}

// The outward normal of a flat shape at its middle; zero for others.
Vec3 front_of(const lights::LightShape& shape, const Primitives& primitives, Hit middle) {
  if (std::holds_alternative<lights::SphereLight>(shape) ||
      std::holds_alternative<lights::CylinderLight>(shape))
    return {};
  middle.b1 = middle.b2 = 1.0f / 3;
  return primitives.surface(Ray{}, middle).geometric_normal;
}

// `shape` is in the space of the primitives, or of the instance's object.
lights::Light light_at(const lights::LightShape& shape, const Primitives& primitives, const Hit& middle,
                       const lights::SurfaceEmission& emission) {
  if (!middle.in_instance()) return lights::AreaLight(shape, front_of(shape, primitives, middle), emission);
  const Instance& instance = primitives.instance(middle.instance);
  if (instance.motion == kStill)
    return lights::AreaLight(placed(shape, instance.placement), front_of(shape, primitives, middle),
                             emission);
  const Hit in_object{.primitive = middle.primitive};
  return lights::MovingAreaLight(shape, front_of(shape, primitives.object_of(instance), in_object), emission,
                                 primitives.motion_of(instance));
}

}  // namespace

AreaLightFinder::AreaLightFinder(const std::vector<Material>& materials, const std::vector<Texture>& textures)
    : materials_(materials) {
  TextureMeans means(textures);
  for (const Material& material : materials) mean_radiances_.push_back(mean_radiance(material, means));
}

void AreaLightFinder::find(const Primitives& primitives, const Quads& quads) {
  map_.own_ = for_each_light_shape(
      primitives, quads.own, [&](std::uint32_t p) { return mean_radiances_[primitives.material(p)] > 0; },
      [&](std::uint32_t p, const lights::QuadLight* quad) {
        return add_light(quad, primitives, {.primitive = p});
      });
  find_in_instances(primitives, quads);
}

void AreaLightFinder::find_in_instances(const Primitives& primitives, const Quads& quads) {
  std::vector<bool> object_emits;
  for (const Primitives& object : primitives.objects()) object_emits.push_back(emits(object));
  const std::uint32_t count = primitives.instance_count();
  for (std::uint32_t i = 0; i < count; ++i) {
    const Instance& instance = primitives.instance(i);
    const bool emissive = instance.material == kOwnMaterials ? object_emits[instance.object]
                                                             : mean_radiances_[instance.material] > 0;
    if (!emissive) continue;
    map_.instances_.resize(count);
    map_.instances_[i].first_light = static_cast<std::uint32_t>(lights_.size());
    map_.instances_[i].table =
        share_table(instance, find_in_instance(primitives, i, quads.of_objects[instance.object]));
  }
}

bool AreaLightFinder::emits(const Primitives& object) const {
  for (std::uint32_t p = 0; p < object.count(); ++p)
    if (mean_radiances_[object.material(p)] > 0) return true;
  return false;
}

LightMap::Table AreaLightFinder::find_in_instance(const Primitives& scene, std::uint32_t number,
                                                  const std::vector<Model::Quad>& quads) {
  const Instance& instance = scene.instance(number);
  const auto first = static_cast<std::uint32_t>(lights_.size());
  return for_each_light_shape(
      scene.object_of(instance), quads,
      [&](std::uint32_t p) {
        return mean_radiances_[scene.material({.primitive = p, .instance = number})] > 0;
      },
      [&](std::uint32_t p, const lights::QuadLight* quad) {
        const std::uint32_t light = add_light(quad, scene, {.primitive = p, .instance = number});
        return light == lights::kNoLight ? lights::kNoLight : light - first;
      });
}

// If rounding leaves a light of some instance without power, the instance gets its own table.
std::uint32_t AreaLightFinder::share_table(const Instance& instance, LightMap::Table table) {
  const auto known = tables_.find({instance.object, instance.material});
  if (known != tables_.end() && map_.tables_[known->second] == table) return known->second;
  const auto number = static_cast<std::uint32_t>(map_.tables_.size());
  tables_[{instance.object, instance.material}] = number;
  map_.tables_.push_back(std::move(table));
  return number;
}

// Returns kNoLight if the light has no power. `middle` identifies the primitive.
std::uint32_t AreaLightFinder::add_light(const lights::QuadLight* quad, const Primitives& primitives,
                                         const Hit& middle) {
  const std::uint32_t material_id = primitives.material(middle);
  const Material& material = materials_[material_id];
  const bool is_textured = material.emission.texture >= 0 || material.opacity.texture >= 0;
  const lights::LightShape shape = quad != nullptr
                                       ? lights::LightShape(*quad)
                                       : shape_of(primitives.owner(middle), middle.primitive, is_textured);
  const lights::SurfaceEmission emission{material.emission, mean_radiances_[material_id],
                                         material.two_sided_emission, material.opacity,
                                         !emits_in_passing(material)};
  const lights::Light light = light_at(shape, primitives, middle, emission);
  const double watts = power(light, 1);
  if (!(watts > 0 && std::isfinite(watts))) return lights::kNoLight;
  lights_.push_back(light);
  materials_of_lights_.push_back(material_id);
  return static_cast<std::uint32_t>(lights_.size()) - 1;
}

}  // namespace tessera::core
