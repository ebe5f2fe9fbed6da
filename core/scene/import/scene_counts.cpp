// SPDX-License-Identifier: Apache-2.0
#include "core/scene/import/scene_counts.hpp"

#include <limits>
#include <set>
#include <variant>
#include <vector>

#include "core/scene/light_count.hpp"
#include "core/scene/loader/scene_keys.hpp"

namespace tessera::core {
namespace {

// Measured: docs/notebook/peers.md.
constexpr std::uint64_t kTreeBytesPerPrimitive = 63;
constexpr std::uint64_t kBytesPerInstance = 256;

template <typename T>
std::uint64_t list_bytes(const std::vector<T>& list) {
  return list.size() * sizeof(T);
}

std::uint64_t mesh_bytes(const MeshDescription& mesh) {
  std::uint64_t of_steps = 0;
  for (const MeshStep& step : mesh.steps)
    of_steps += list_bytes(step.positions) + list_bytes(step.normals) + list_bytes(step.tangents);
  return list_bytes(mesh.positions) + list_bytes(mesh.normals) + list_bytes(mesh.uvs) +
         list_bytes(mesh.second_uvs) + list_bytes(mesh.triangles) + list_bytes(mesh.triangle_materials) +
         list_bytes(mesh.colors) + list_bytes(mesh.tangents) + of_steps;
}

// As if each segment had half of the most parts that it may have.
std::uint64_t curve_bytes(const CurveStrands& strands) {
  constexpr std::uint64_t kPartBytes = 16, kPointBytes = 16;
  return kPointBytes * strands.points.size() +
         kMaxCurveParts / 2 * (kTreeBytesPerPrimitive + kPartBytes) * segment_count(strands);
}

std::uint64_t saturating_sum(std::uint64_t a, std::uint64_t b) {
  const std::uint64_t sum = a + b;
  return sum < a ? std::numeric_limits<std::uint64_t>::max() : sum;
}

class SceneCounter {
 public:
  explicit SceneCounter(const SceneDescription& scene) : scene_(scene) {}

  SceneCounts count();

 private:
  // Counts what is stored, and returns the triangles that rays can hit.
  std::uint64_t count_shapes(const std::vector<ShapeDescription>& shapes);
  void count_images();

  const SceneDescription& scene_;
  std::vector<std::uint64_t> triangles_of_objects_;
  SceneCounts counts_;
};

std::uint64_t SceneCounter::count_shapes(const std::vector<ShapeDescription>& shapes) {
  std::uint64_t triangles = 0;
  for (const ShapeDescription& shape : shapes) {
    ++counts_.shapes[scene_keys::kShapeTypes[shape.index()]];
    if (const auto* mesh = std::get_if<MeshDescription>(&shape)) {
      counts_.triangles += mesh->triangles.size();
      if (!mesh->steps.empty()) counts_.deforming_triangles += mesh->triangles.size();
      counts_.memory_bytes += mesh_bytes(*mesh) + kTreeBytesPerPrimitive * mesh->triangles.size();
      triangles = saturating_sum(triangles, mesh->triangles.size());
    } else if (const auto* instance = std::get_if<InstanceDescription>(&shape)) {
      counts_.memory_bytes += kBytesPerInstance;
      if (instance->object < triangles_of_objects_.size())
        triangles = saturating_sum(triangles, triangles_of_objects_[instance->object]);
    } else if (const auto* curves = std::get_if<CurvesDescription>(&shape)) {
      counts_.curve_segments += segment_count(curves->strands);
      counts_.memory_bytes += curve_bytes(curves->strands);
    } else {
      counts_.memory_bytes += kTreeBytesPerPrimitive + sizeof(ShapeDescription);
    }
  }
  return triangles;
}

void SceneCounter::count_images() {
  std::set<const TextureImage*> seen;
  for (const Texture& texture : scene_.textures) {
    if (!texture.image || !seen.insert(texture.image.get()).second) continue;
    ++counts_.images;
    counts_.image_pixels += std::uint64_t(texture.image->width()) * std::uint64_t(texture.image->height());
    counts_.memory_bytes += image_bytes(*texture.image);
  }
}

SceneCounts SceneCounter::count() {
  for (const ObjectDescription& object : scene_.objects)
    triangles_of_objects_.push_back(count_shapes(object.shapes));
  counts_.triangles_with_instances = count_shapes(scene_.shapes);
  for (const Material& material : scene_.materials)
    ++counts_.materials[scene_keys::kMaterialTypes[material.model.index()]];
  for (const LightDescription& light : scene_.lights)
    ++counts_.lights[scene_keys::kLightTypes[light.index()]];
  counts_.emissive_shapes = count_area_lights(scene_);
  count_images();
  for (const VoxelGrid& grid : scene_.grids) counts_.memory_bytes += list_bytes(grid.values);
  return counts_;
}

}  // namespace

std::uint64_t image_bytes(const TextureImage& image) {
  return list_bytes(image.texels().tiles) + list_bytes(image.texels().floats);
}

SceneCounts count_scene(const SceneDescription& scene) {
  return SceneCounter(scene).count();
}

}  // namespace tessera::core
