// SPDX-License-Identifier: Apache-2.0
// Sorts the hits of a batch into bins of vertices that are shaded together: of one kernel, and layered ones
// of the same model, which mostly have the same lobes. For use by one thread.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/integrators/path_queue.hpp"
#include "core/math/lane_array.hpp"
#include "core/scene/scene.hpp"

namespace tessera::core {

enum class ShadingBin : std::uint8_t {
  kDiffuse,
  kGlossy,
  kPhong,
  kSpecular,
  kPrincipled,
  kClearPrincipled,
  kPlastic,
  kConductor,
  kDiffuseTransmission,
  kThinDielectric,
  kMixed,
  kBlends,   // until it is known which part scatters
  kEscaped,  // rays that hit nothing
};
inline constexpr std::size_t kShadingBins = 13;

// What sorting needs to know of a material.
struct MaterialBin {
  ShadingBin bin;
  bool emissive;
};
std::vector<MaterialBin> material_bins(std::span<const Material> materials);

class ShadingBins {
 public:
  // `of_materials` are the material_bins() of the scene. Keeps references.
  ShadingBins(const Scene& scene, std::span<const MaterialBin> of_materials)
      : scene_(scene), of_materials_(of_materials) {}

  // hits[i] is that of rays[i], of which there are at most kBatchPaths.
  void sort(std::span<const Ray> rays, std::span<const Hit> hits);

  // The results of sort() by slot, which is the number of the ray: the material that scatters, null for
  // escaped rays, and whether the surface may be emissive.
  const Material* material(std::uint32_t slot) const { return materials_[slot]; }
  bool is_emissive(std::uint32_t slot) const { return emissive_[slot]; }

  // Calls what(bin, slots, plain_triangles) for up to kLaneCount slots of a bin at a time.
  // `plain_triangles`: that Primitives::is_plain_triangle() holds for all hits.
  template <typename What>
  void for_each_group(const What& what) const {
    for (std::size_t bin = 0; bin < kShadingBins; ++bin)
      for (std::size_t i = 0; i < bins_[bin].size(); i += kLaneCount) {
        const std::size_t count = std::min(kLaneCount, bins_[bin].size() - i);
        what(static_cast<ShadingBin>(bin), std::span(bins_[bin].slots).subspan(i, count),
             i + count <= bins_[bin].triangles);
      }
  }

 private:
  // Plain triangles are the first ones, and all others the last ones of the array while hits are sorted, so
  // that few groups of lanes have both.
  struct Slots {
    std::size_t size() const { return triangles + others; }

    std::size_t triangles = 0, others = 0;
    std::array<std::uint32_t, kBatchPaths> slots;
  };

  Slots& slots_of(ShadingBin bin) { return bins_[static_cast<std::size_t>(bin)]; }
  void prefetch(std::span<const Hit> hits) const;
  void add(ShadingBin bin, std::uint32_t slot, bool plain_triangle);
  void add_hit(const Hit& hit, std::uint32_t slot);
  void add_parts_of_blends(std::span<const Ray> rays, std::span<const Hit> hits);

  const Scene& scene_;
  const std::span<const MaterialBin> of_materials_;
  std::array<bool, kBatchPaths> emissive_;
  std::array<const Material*, kBatchPaths> materials_;
  std::array<Slots, kShadingBins> bins_;
};

}  // namespace tessera::core
