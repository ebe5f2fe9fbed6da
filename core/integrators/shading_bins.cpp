// SPDX-License-Identifier: Apache-2.0
#include "core/integrators/shading_bins.hpp"

#include <cassert>
#include <variant>

#include "core/base/overloaded.hpp"
#include "core/integrators/vertex_batch.hpp"

namespace tessera::core {
namespace {

ShadingBin bin_of(const Material& material) {
  if (std::holds_alternative<Blend>(material.model)) return ShadingBin::kBlends;
  switch (kernel_of(material)) {
    case Kernel::kDiffuse:
      return ShadingBin::kDiffuse;
    case Kernel::kGlossy:
      return ShadingBin::kGlossy;
    case Kernel::kPhong:
      return ShadingBin::kPhong;
    case Kernel::kSpecular:
      return ShadingBin::kSpecular;
    case Kernel::kLayered:
      break;
    case Kernel::kMixed:
      return ShadingBin::kMixed;
  }
  return std::visit(Overloaded{
                        [&](const Principled&) {
                          return transmits_light(material.model) ? ShadingBin::kClearPrincipled
                                                                 : ShadingBin::kPrincipled;
                        },
                        [](const Plastic&) { return ShadingBin::kPlastic; },
                        [](const ConductorMaterial&) { return ShadingBin::kConductor; },
                        [](const DiffuseTransmission&) { return ShadingBin::kDiffuseTransmission; },
                        [](const ThinDielectric&) { return ShadingBin::kThinDielectric; },
                        [](const auto&) { return ShadingBin::kMixed; },
                    },
                    material.model);
}

}  // namespace

std::vector<MaterialBin> material_bins(std::span<const Material> materials) {
  std::vector<MaterialBin> bins;
  bins.reserve(materials.size());
  for (const Material& material : materials)
    bins.push_back({bin_of(material), !is_black(material.emission.value)});
  return bins;
}

void ShadingBins::sort(std::span<const Ray> rays, std::span<const Hit> hits) {
  assert(hits.size() == rays.size() && hits.size() <= kBatchPaths);
  for (Slots& bin : bins_) bin.triangles = bin.others = 0;
  prefetch(hits);
  for (std::uint32_t slot = 0; slot < hits.size(); ++slot) add_hit(hits[slot], slot);
  if (slots_of(ShadingBin::kBlends).size() > 0) add_parts_of_blends(rays, hits);
  for (Slots& bin : bins_)
    if (bin.size() < kBatchPaths)
      std::copy(bin.slots.end() - static_cast<std::ptrdiff_t>(bin.others), bin.slots.end(),
                bin.slots.begin() + static_cast<std::ptrdiff_t>(bin.triangles));
}

// The data of all triangle vertices may be spread over memory.
void ShadingBins::prefetch(std::span<const Hit> hits) const {
  for (const Hit& hit : hits) {
    if (!hit.found()) continue;
    const Primitives& owner = scene_.primitives().owner(hit);
    if (owner.is_triangle(hit.primitive)) owner.prefetch_triangle(hit.primitive);
  }
}

void ShadingBins::add(ShadingBin bin, std::uint32_t slot, bool plain_triangle) {
  Slots& into = slots_of(bin);
  into.slots[plain_triangle ? into.triangles++ : kBatchPaths - ++into.others] = slot;
}

void ShadingBins::add_hit(const Hit& hit, std::uint32_t slot) {
  emissive_[slot] = false;
  if (!hit.found()) {
    materials_[slot] = nullptr;
    return add(ShadingBin::kEscaped, slot, true);
  }
  const Primitives& primitives = scene_.primitives();
  const Primitives& owner = primitives.owner(hit);
  const bool triangle = owner.is_triangle(hit.primitive);
  if (triangle) owner.prefetch_corners(hit.primitive);
  const std::uint32_t material = primitives.material(hit);
  const auto [bin, emissive] = of_materials_[material];
  materials_[slot] = &scene_.materials()[material];
  emissive_[slot] = emissive;
  add(bin, slot, triangle && primitives.is_plain(hit));
}

// Each slot of a blend moves to the bin of the part that scatters.
void ShadingBins::add_parts_of_blends(std::span<const Ray> rays, std::span<const Hit> hits) {
  Slots& blends = slots_of(ShadingBin::kBlends);
  const auto move = [&](std::uint32_t slot, bool plain_triangle) {
    const Ray& ray = rays[slot];
    const SurfacePoint surface = scene_.primitives().surface(ray, hits[slot]);
    materials_[slot] = &scatterer_of(scene_, hits[slot], surface, normalize(-ray.direction));
    const auto part = static_cast<std::size_t>(materials_[slot] - scene_.materials().data());
    add(of_materials_[part].bin, slot, plain_triangle);
  };
  for (std::size_t i = 0; i < blends.triangles; ++i) move(blends.slots[i], true);
  for (std::size_t i = kBatchPaths - blends.others; i < kBatchPaths; ++i) move(blends.slots[i], false);
  blends.triangles = blends.others = 0;
}

}  // namespace tessera::core
