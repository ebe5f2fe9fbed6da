// SPDX-License-Identifier: Apache-2.0
#include "core/integrators/shading_bins.hpp"

#include <cassert>
#include <compare>
#include <variant>

namespace tessera::core::integrators {
namespace {

// What vertices have in common that are shaded together. Models and microfacets count only for kernels that
// need them to be the same in all lanes.
struct Signature {
  Kernel kernel;
  std::size_t model = 0;
  bool transmits = false;  // Principled ones have lobes that others lack
  MicrofacetDistribution distribution{};
  SmithMasking masking{};

  auto operator<=>(const Signature&) const = default;
};

MicrofacetKind microfacets_of(const MaterialModel& model) {
  if (const auto* glass = std::get_if<Glass>(&model)) return glass->microfacets;
  if (const auto* plastic = std::get_if<Plastic>(&model)) return plastic->microfacets;
  if (const auto* metal = std::get_if<ConductorMaterial>(&model)) return metal->microfacets;
  return {};
}

Signature signature_of(const Material& material) {
  const Kernel kernel = kernel_of(material);
  if (kernel != Kernel::kLayered && kernel != Kernel::kGeneral) return {kernel};
  const auto [distribution, masking] = microfacets_of(material.model);
  return {kernel, material.model.index(), transmits_light(material.model), distribution, masking};
}

std::uint32_t index_of(const Scene& scene, const Material& material) {
  return static_cast<std::uint32_t>(&material - scene.materials().data());
}

bool is_nested(const Scene& scene, const Material& material) {
  return scene.nested_dielectrics().contains(index_of(scene, material));
}

// Whether what scatters differs from hit to hit: a part of a blend, or a boundary of nested dielectrics.
bool depends_on_hit(const Scene& scene, const Material& material) {
  return std::holds_alternative<Blend>(material.model) || is_nested(scene, material);
}

// Those of the materials that scatter, in order.
std::vector<Signature> signatures_of(const Scene& scene) {
  std::vector<Signature> signatures;
  for (const Material& material : scene.materials())
    if (!depends_on_hit(scene, material)) signatures.push_back(signature_of(material));
  std::sort(signatures.begin(), signatures.end());
  signatures.erase(std::unique(signatures.begin(), signatures.end()), signatures.end());
  return signatures;
}

// A hit of which only the primitive and the instance are known.
Hit place_of(ColumnsView<const Hit> hits, std::size_t i) {
  Hit place;
  place.primitive = hits.get(&Hit::primitive, i);
  place.instance = hits.get(&Hit::instance, i);
  return place;
}

}  // namespace

MaterialBins material_bins(const Scene& scene) {
  const std::vector<Signature> signatures = signatures_of(scene);
  MaterialBins bins;
  for (const Signature& signature : signatures) bins.kernels.push_back(signature.kernel);
  bins.of_materials.reserve(scene.materials().size());
  for (const Material& material : scene.materials()) {
    const auto place = depends_on_hit(scene, material)
                           ? signatures.end()
                           : std::lower_bound(signatures.begin(), signatures.end(), signature_of(material));
    bins.of_materials.push_back(
        {static_cast<std::uint32_t>(place - signatures.begin()), !is_black(material.emission.value)});
  }
  return bins;
}

void ShadingBins::Slots::close_gap() {
  if (size() < kBatchPaths)
    std::copy(slots.end() - static_cast<std::ptrdiff_t>(others), slots.end(),
              slots.begin() + static_cast<std::ptrdiff_t>(triangles));
}

void ShadingBins::sort(ColumnsView<const Ray> rays, ColumnsView<const Hit> hits,
                       std::span<const Material* const> boundaries) {
  assert(hits.size() == rays.size() && hits.size() <= kBatchPaths);
  for (Slots& bin : bins_) bin.triangles = bin.others = 0;
  escaped_.triangles = 0;
  prefetch(hits);
  for (std::uint32_t slot = 0; slot < hits.size(); ++slot) add_hit(place_of(hits, slot), slot);
  if (bins_.back().size() > 0) find_scatterers(rays, hits, boundaries);
  for (Slots& bin : bins_) bin.close_gap();
}

// The data of all triangle vertices and curves may be spread over memory.
void ShadingBins::prefetch(ColumnsView<const Hit> hits) const {
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const Hit hit = place_of(hits, i);
    if (!hit.found()) continue;
    scene_.primitives().owner(hit).prefetch_shape(hit.primitive);
  }
}

void ShadingBins::add_hit(const Hit& hit, std::uint32_t slot) {
  emissive_[slot] = false;
  if (!hit.found()) {
    materials_[slot] = nullptr;
    return escaped_.add(slot, true);
  }
  const Primitives& primitives = scene_.primitives();
  const Primitives& owner = primitives.owner(hit);
  const bool triangle = owner.is_triangle(hit.primitive);
  owner.prefetch_surface(hit.primitive);
  const std::uint32_t material = primitives.material(hit);
  const auto [bin, emissive] = of_scene_.of_materials[material];
  materials_[slot] = &scene_.materials()[material];
  emissive_[slot] = emissive;
  bins_[bin].add(slot, triangle && primitives.is_plain(hit));
}

// Each slot of the last bin moves to that of the material that scatters.
void ShadingBins::find_scatterers(ColumnsView<const Ray> rays, ColumnsView<const Hit> hits,
                                  std::span<const Material* const> boundaries) {
  const auto scatterer_at = [&](std::uint32_t slot) -> const Material& {
    if (is_nested(scene_, *materials_[slot])) return *boundaries[slot];
    const Ray ray = rays[slot];
    const Hit hit = hits[slot];
    const SurfacePoint surface = scene_.primitives().surface(ray, hit);
    return scatterer_of(scene_, hit, surface, normalize(-ray.direction));
  };
  Slots& slots = bins_.back();
  const auto move = [&](std::uint32_t slot, bool plain_triangle) {
    materials_[slot] = &scatterer_at(slot);
    bins_[of_scene_.of_materials[index_of(scene_, *materials_[slot])].bin].add(slot, plain_triangle);
  };
  for (std::size_t i = 0; i < slots.triangles; ++i) move(slots.slots[i], true);
  for (std::size_t i = kBatchPaths - slots.others; i < kBatchPaths; ++i) move(slots.slots[i], false);
  slots.triangles = slots.others = 0;
}

}  // namespace tessera::core::integrators
