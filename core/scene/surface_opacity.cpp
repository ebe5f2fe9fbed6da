// SPDX-License-Identifier: Apache-2.0
#include "core/scene/surface_opacity.hpp"

#include "core/textures/opacity.hpp"

namespace tessera::core {
namespace {

bool cuts_out(const ScalarParameter& opacity, const std::vector<Texture>& textures) {
  return opacity.texture < 0 ? !(opacity.value > 0) : image_of_opacity(opacity, textures) != nullptr;
}

}  // namespace

std::vector<accel::MaterialOpacity> opacities_of(const std::vector<Material>& materials,
                                                 const std::vector<Texture>& textures,
                                                 const NestedDielectrics& nested) {
  std::vector<accel::MaterialOpacity> opacities;
  for (std::uint32_t i = 0; i < materials.size(); ++i) {
    const Material& material = materials[i];
    const bool is_nested = nested.contains(i);
    if (!is_nested && is_opaque(material, materials)) {
      opacities.push_back(accel::MaterialOpacity::kOpaque);
    } else if (!is_nested && !material.media.changes_medium() && cuts_out(material.opacity, textures)) {
      opacities.push_back(accel::MaterialOpacity::kCutOut);
    } else {
      opacities.push_back(accel::MaterialOpacity::kPartial);
    }
  }
  return opacities;
}

accel::Opacity SurfaceOpacity::at(const Hit& hit) const {
  const std::uint32_t material = primitives_.material(hit);
  switch (opacities_[material]) {
    case accel::MaterialOpacity::kOpaque:
      return accel::Opacity::kOpaque;
    case accel::MaterialOpacity::kPartial:
      return accel::Opacity::kPartial;
    case accel::MaterialOpacity::kCutOut:
      break;
  }
  return of_cut_out(materials_[material], hit);
}

accel::Opacity SurfaceOpacity::of_cut_out(const Material& material, const Hit& hit) const {
  if (material.opacity.texture < 0) return accel::Opacity::kTransparent;
  // Other shapes may be met a second time, which traversal does not ask about.
  if (!primitives_.owner(hit).is_triangle(hit.primitive)) return accel::Opacity::kPartial;
  const float opacity = opacity_at(material.opacity, textures_, primitives_.triangle_uv_sets(hit));
  if (opacity == 0) return accel::Opacity::kTransparent;
  return opacity == 1 && is_opaque_model(material, materials_) ? accel::Opacity::kOpaque
                                                               : accel::Opacity::kPartial;
}

}  // namespace tessera::core
