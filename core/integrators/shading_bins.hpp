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

#include "core/integrators/path_state.hpp"
#include "core/integrators/vertex_batch.hpp"
#include "core/math/lane_array.hpp"
#include "core/scene/scene.hpp"

namespace tessera::core::integrators {

// What sorting needs to know of a scene's materials.
struct MaterialBins {
  struct OfMaterial {
    std::uint32_t bin;
    bool emissive;
  };
  // Of each bin. Blends and nested dielectrics have one more, until it is known what scatters.
  std::vector<Kernel> kernels;
  std::vector<OfMaterial> of_materials;
};
MaterialBins material_bins(const Scene& scene);

class ShadingBins {
 public:
  // `of_scene` are its material_bins(). Keeps references.
  ShadingBins(const Scene& scene, const MaterialBins& of_scene)
      : scene_(scene), of_scene_(of_scene), bins_(of_scene.kernels.size() + 1) {}

  // hits[i] is that of rays[i], of which there are at most kBatchPaths. Where a nested dielectric was hit,
  // boundaries[i] scatters.
  void sort(ColumnsView<const Ray> rays, ColumnsView<const Hit> hits,
            std::span<const Material* const> boundaries);

  // The results of sort() by slot, which is the number of the ray: the material that scatters, null for
  // escaped rays, and whether the surface may be emissive.
  const Material* material(std::uint32_t slot) const { return materials_[slot]; }
  bool is_emissive(std::uint32_t slot) const { return emissive_[slot]; }

  // Calls what(kernel, slots, plain_triangles) for up to kLaneCount slots of a bin at a time.
  // `plain_triangles`: that Primitives::is_plain_triangle() holds for all hits.
  template <typename What>
  void for_each_group(const What& what) const {
    for (std::size_t bin = 0; bin < of_scene_.kernels.size(); ++bin)
      for_each_group_of(bins_[bin], [&](std::span<const std::uint32_t> slots, bool plain_triangles) {
        what(of_scene_.kernels[bin], slots, plain_triangles);
      });
  }
  // Calls what(slots) for rays that hit nothing.
  template <typename What>
  void for_each_escaped(const What& what) const {
    for_each_group_of(escaped_, [&](std::span<const std::uint32_t> slots, bool) { what(slots); });
  }

 private:
  // Plain triangles are the first ones, and all others the last ones of the array while hits are sorted, so
  // that few groups of lanes have both.
  struct Slots {
    std::size_t size() const { return triangles + others; }
    void add(std::uint32_t slot, bool plain_triangle) {
      slots[plain_triangle ? triangles++ : kBatchPaths - ++others] = slot;
    }
    void close_gap();

    std::size_t triangles = 0, others = 0;
    std::array<std::uint32_t, kBatchPaths> slots;
  };

  template <typename What>
  static void for_each_group_of(const Slots& bin, const What& what) {
    for (std::size_t i = 0; i < bin.size(); i += kLaneCount) {
      const std::size_t count = std::min(kLaneCount, bin.size() - i);
      what(std::span(bin.slots).subspan(i, count), i + count <= bin.triangles);
    }
  }
  void prefetch(ColumnsView<const Hit> hits) const;
  void add_hit(const Hit& hit, std::uint32_t slot);
  void find_scatterers(ColumnsView<const Ray> rays, ColumnsView<const Hit> hits,
                       std::span<const Material* const> boundaries);

  const Scene& scene_;
  const MaterialBins& of_scene_;
  std::array<bool, kBatchPaths> emissive_;
  std::array<const Material*, kBatchPaths> materials_;
  std::vector<Slots> bins_;
  Slots escaped_;
};

}  // namespace tessera::core::integrators
