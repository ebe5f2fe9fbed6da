// SPDX-License-Identifier: Apache-2.0
#include "core/scene/light_count.hpp"

#include <algorithm>
#include <vector>

namespace tessera::core {
namespace {

// The numbers of an object's primitives: all, and those emissive by the object's own materials.
struct ObjectCount {
  std::uint64_t shapes = 0, emissive = 0;
};

class LightCounter {
 public:
  explicit LightCounter(const SceneDescription& scene) {
    for (const Material& material : scene.materials) emits_.push_back(!is_black(material.emission.value));
    for (const ObjectDescription& object : scene.objects) objects_.push_back(count(object.shapes));
  }

  ObjectCount count(const std::vector<ShapeDescription>& shapes) const {
    ObjectCount total;
    for (const ShapeDescription& shape : shapes) {
      const ObjectCount more = std::visit([this](const auto& s) { return count(s); }, shape);
      total.shapes += more.shapes;
      total.emissive += more.emissive;
    }
    return total;
  }

 private:
  ObjectCount count(const MeshDescription& mesh) const {
    const std::uint64_t triangles = mesh.triangles.size();
    const auto& materials = mesh.triangle_materials;
    const auto emissive = static_cast<std::uint64_t>(
        std::count_if(materials.begin(), materials.end(), [this](std::uint32_t m) { return emits_[m]; }));
    return {triangles, materials.size() == 1 ? emissive * triangles : emissive};
  }
  ObjectCount count(const SphereDescription& sphere) const { return {1, emits_[sphere.material]}; }
  ObjectCount count(const QuadDescription& quad) const { return {1, emits_[quad.material]}; }
  ObjectCount count(const DiskDescription& disk) const { return {1, emits_[disk.material]}; }
  ObjectCount count(const CylinderDescription& cylinder) const { return {1, emits_[cylinder.material]}; }
  ObjectCount count(const CurvesDescription& curves) const { return {segment_count(curves.strands), 0}; }
  ObjectCount count(const InstanceDescription& instance) const {
    const ObjectCount& object = objects_[instance.object];
    if (!instance.material) return object;
    return {object.shapes, emits_[*instance.material] ? object.shapes : 0};
  }

  std::vector<bool> emits_;
  std::vector<ObjectCount> objects_;
};

}  // namespace

std::uint64_t count_area_lights(const SceneDescription& scene) {
  return LightCounter(scene).count(scene.shapes).emissive;
}

}  // namespace tessera::core
