// SPDX-License-Identifier: Apache-2.0
// Bvh::set_opacities.
#include <algorithm>
#include <vector>

#include "core/accel/bvh.hpp"

namespace tessera::core::accel {
namespace {

using Opacities = std::span<const MaterialOpacity>;

// The greatest opacity that instances give each object instead of its own.
std::vector<MaterialOpacity> replaced_in_objects(const Primitives& scene, Opacities of_materials) {
  std::vector<MaterialOpacity> replaced(scene.objects().size(), MaterialOpacity::kOpaque);
  for (std::uint32_t i = 0; i < scene.instance_count(); ++i) {
    const Instance& instance = scene.instance(i);
    if (instance.material == kOwnMaterials) continue;
    MaterialOpacity& opacity = replaced[instance.object];
    opacity = std::max(opacity, of_materials[instance.material]);
  }
  return replaced;
}

// Marks packets of `owner`, where they have at least the opacity `least`.
void mark(HugePageArray<BvhPacket>& packets, const Primitives& owner, Opacities of_materials,
          MaterialOpacity least, int threads) {
#pragma omp parallel for num_threads(threads)
  for (std::size_t i = 0; i < packets.size(); ++i) {
    BvhPacket& packet = packets[i];
    if (packet.kind == GeometryKind::kInstance) continue;
    packet.opacity = least;
    for_each_lane(packet.lanes, [&](std::size_t lane) {
      packet.opacity = std::max(packet.opacity, of_materials[owner.material(packet.primitives[lane])]);
    });
  }
}

}  // namespace

void Bvh::set_opacities(const Primitives& primitives, Opacities of_materials, int threads) {
  const auto replaced = replaced_in_objects(primitives, of_materials);
  mark(arrays_.packets, primitives, of_materials, MaterialOpacity::kOpaque, threads);
  for (std::size_t i = 0; i < arrays_.objects.size(); ++i)
    mark(arrays_.objects[i].packets, primitives.objects()[i], of_materials, replaced[i], threads);
}

}  // namespace tessera::core::accel
