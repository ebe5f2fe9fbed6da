// SPDX-License-Identifier: Apache-2.0
#include "core/scene/import/empty_objects.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace tessera::core {
namespace {

constexpr std::uint32_t kRemoved = std::numeric_limits<std::uint32_t>::max();

// The new index of each object.
std::vector<std::uint32_t> remove_objects(std::vector<ObjectDescription>& objects) {
  std::vector<std::uint32_t> indices;
  std::uint32_t kept = 0;
  for (const ObjectDescription& object : objects)
    indices.push_back(object.shapes.empty() ? kRemoved : kept++);
  std::erase_if(objects, [](const ObjectDescription& object) { return object.shapes.empty(); });
  return indices;
}

void renumber_motions(SceneDescription& scene, const std::vector<std::uint32_t>& shapes) {
  auto& motions = scene.animation.instances;
  for (InstanceMotion& motion : motions) motion.shape = shapes[motion.shape];
  std::erase_if(motions, [](const InstanceMotion& motion) { return motion.shape == kRemoved; });
}

// Keeps the shapes that `keep(i)` is true of. The new index of each shape.
template <typename Keep>
std::vector<std::uint32_t> keep_shapes(std::vector<ShapeDescription>& shapes, std::vector<std::string>& names,
                                       const Keep& keep) {
  std::vector<std::uint32_t> indices;
  std::uint32_t kept = 0;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (!keep(i)) {
      indices.push_back(kRemoved);
      continue;
    }
    if (kept != i) {
      shapes[kept] = std::move(shapes[i]);
      names[kept] = std::move(names[i]);
    }
    indices.push_back(kept++);
  }
  shapes.resize(kept);
  names.resize(kept);
  return indices;
}

// The new index of each shape.
std::vector<std::uint32_t> remove_instances(std::vector<ShapeDescription>& shapes,
                                            std::vector<std::string>& names,
                                            const std::vector<std::uint32_t>& objects) {
  return keep_shapes(shapes, names, [&](std::size_t i) {
    auto* instance = std::get_if<InstanceDescription>(&shapes[i]);
    if (instance == nullptr) return true;
    instance->object = objects[instance->object];
    return instance->object != kRemoved;
  });
}

}  // namespace

void remove_empty_objects(SceneDescription& scene) {
  const auto is_empty = [](const ObjectDescription& object) { return object.shapes.empty(); };
  // An object may become empty itself by losing its instances.
  while (std::any_of(scene.objects.begin(), scene.objects.end(), is_empty)) {
    const std::vector<std::uint32_t> objects = remove_objects(scene.objects);
    for (ObjectDescription& object : scene.objects)
      remove_instances(object.shapes, object.shape_names, objects);
    renumber_motions(scene, remove_instances(scene.shapes, scene.shape_names, objects));
  }
}

void remove_shapes(SceneDescription& scene, const std::vector<std::size_t>& indices) {
  const std::set<std::size_t> removed(indices.begin(), indices.end());
  if (removed.empty()) return;
  renumber_motions(scene, keep_shapes(scene.shapes, scene.shape_names,
                                      [&](std::size_t i) { return !removed.contains(i); }));
}

}  // namespace tessera::core
