// SPDX-License-Identifier: Apache-2.0
// Finds the area lights among a scene's primitives, including those in instances: each emissive triangle,
// quad, sphere, disk and cylinder is a light, once per instance.
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "core/geometry/ray.hpp"
#include "core/lights/light.hpp"
#include "core/lights/light_sampler.hpp"
#include "core/materials/material.hpp"
#include "core/scene/model.hpp"

namespace tessera::core {

// Maps hits to lights. Instances with the same sequence of lights share a table.
class LightMap {
 public:
  std::uint32_t light_of(const Hit& hit) const {
    return hit.in_instance() ? light_in_instance(hit) : entry(own_, hit.primitive);
  }

 private:
  friend class AreaLightFinder;

  // For each primitive, up to the last emissive one: its light's index relative to the instance's first
  // light, or kNoLight.
  using Table = std::vector<std::uint32_t>;
  struct InstanceLights {
    std::uint32_t table = kNoTable;
    std::uint32_t first_light = 0;
  };
  static constexpr std::uint32_t kNoTable = 0xffffffffu;

  static std::uint32_t entry(const Table& table, std::uint32_t primitive) {
    return primitive < table.size() ? table[primitive] : lights::kNoLight;
  }

  std::uint32_t light_in_instance(const Hit& hit) const {
    if (instances_.empty()) return lights::kNoLight;
    const InstanceLights& lights = instances_[hit.instance];
    if (lights.table == kNoTable) return lights::kNoLight;
    const std::uint32_t number = entry(tables_[lights.table], hit.primitive);
    return number == lights::kNoLight ? lights::kNoLight : lights.first_light + number;
  }

  Table own_;
  std::vector<InstanceLights> instances_;  // empty if no instance is emissive
  std::vector<Table> tables_;
};

class AreaLightFinder {
 public:
  AreaLightFinder(const std::vector<Material>& materials, const std::vector<Texture>& textures);

  // The quads of a scene and of its objects, in the order of their triangles.
  struct Quads {
    std::vector<Model::Quad> own;
    std::vector<std::vector<Model::Quad>> of_objects;
  };

  // Finds the lights of the scene's own primitives, then those of its instances. Lights without power are
  // left out.
  void find(const Primitives& scene, const Quads& quads);

  std::vector<lights::Light> take_lights() { return std::move(lights_); }
  // Of each light.
  const std::vector<std::uint32_t>& materials() const { return materials_of_lights_; }
  LightMap take_map() { return std::move(map_); }

 private:
  void find_in_instances(const Primitives& primitives, const Quads& quads);
  bool emits(const Primitives& object) const;
  LightMap::Table find_in_instance(const Primitives& scene, std::uint32_t number,
                                   const std::vector<Model::Quad>& quads);
  std::uint32_t share_table(const Instance& instance, LightMap::Table table);
  // `quad` is that of the primitive, or null.
  std::uint32_t add_light(const lights::QuadLight* quad, const Primitives& primitives, const Hit& middle);

  const std::vector<Material>& materials_;
  std::vector<double> mean_radiances_;  // of the emission of each material
  std::vector<lights::Light> lights_;
  std::vector<std::uint32_t> materials_of_lights_;
  LightMap map_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> tables_;  // by object and material
};

}  // namespace tessera::core
