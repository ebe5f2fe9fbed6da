// SPDX-License-Identifier: Apache-2.0
#include "core/scene/pbrt/surfaces.hpp"

#include <utility>

namespace tessera::core::pbrt {

bool Surfaces::is_textured(const Surface& surface) const {
  const bool light = surface.light && surface.light->is_textured();
  const bool alpha = surface.alpha && constant_of(surface.alpha) == nullptr;
  return light || alpha || materials_.is_textured(surface.material);
}

bool Surfaces::has_sides(const Surface& surface) const {
  if (surface.light && !surface.light->two_sided) return true;
  return surface.media.changes_medium() ||
         std::holds_alternative<Glass>(materials_.at(surface.material).model);
}

Result<std::optional<std::uint32_t>> Surfaces::material(Surface surface, double area, const Place& place) {
  if (std::holds_alternative<Null>(materials_.at(surface.material).model)) {
    if (surface.light) {
      report_.warn(place, "an emitter whose material is \"interface\" does not emit, as in pbrt");
      surface.light = nullptr;
    }
    if (!surface.media.changes_medium()) return std::nullopt;
  }
  const double power_area = surface.light && surface.light->power && area > 0 ? area : 0;
  const Key key(surface.material, surface.light.get(), surface.alpha.get(), surface.media.interior,
                surface.media.exterior, power_area);
  const auto known = made_.find(key);
  if (known != made_.end()) return known->second.index;
  auto material = make(surface, area, place);
  if (!material) return fail(material.error());
  const std::uint32_t index = builder_.add_material(std::move(*material));
  made_.emplace(key, Made{surface, index});
  return index;
}

Result<Material> Surfaces::make(const Surface& surface, double area, const Place& place) {
  Material material = materials_.at(surface.material);
  material.media = surface.media;
  if (surface.alpha) {
    auto opacity = baker_.scalar(surface.alpha, 1, place);
    if (!opacity) return fail(opacity.error());
    material.opacity = *opacity;
  }
  if (!surface.light) return material;
  if (surface.alpha && material.opacity.texture < 0 && material.opacity.value <= 0) {
    report_.warn(place, "an emitter that is invisible is seen in mirrors and through glass");
    material.model = Null{};
    material.opacity = 1;
    material.media = {};
    material.visible_to_camera = false;
  }
  material.emission = surface.light->radiance_of(area);
  material.two_sided_emission = surface.light->two_sided;
  return material;
}

}  // namespace tessera::core::pbrt
