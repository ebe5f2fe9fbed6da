// SPDX-License-Identifier: Apache-2.0
// Which surfaces of a scene stop every ray, and what those that do not are at a hit, for traversal. Image
// textures cut out of triangles. All else that varies over a surface is partly opaque: integrators evaluate
// it. Thread-safe.
#pragma once

#include <vector>

#include "core/accel/hit_opacity.hpp"
#include "core/geometry/primitives.hpp"
#include "core/materials/material.hpp"
#include "core/scene/nested_dielectrics.hpp"

namespace tessera::core {

// The opacity of each material of a scene, as it is without regard to the camera. Nested dielectrics may have
// no effect. Surfaces between media are met even where they are transparent.
std::vector<accel::MaterialOpacity> opacities_of(const std::vector<Material>& materials,
                                                 const std::vector<Texture>& textures,
                                                 const NestedDielectrics& nested);

class SurfaceOpacity final : public accel::HitOpacity {
 public:
  // Keeps references. `opacities` are those of the materials.
  SurfaceOpacity(const Primitives& primitives, const std::vector<Material>& materials,
                 const std::vector<Texture>& textures, const std::vector<accel::MaterialOpacity>& opacities)
      : primitives_(primitives), materials_(materials), textures_(textures), opacities_(opacities) {}

  accel::Opacity at(const Hit& hit) const override;

 private:
  accel::Opacity of_cut_out(const Material& material, const Hit& hit) const;

  const Primitives& primitives_;
  const std::vector<Material>& materials_;
  const std::vector<Texture>& textures_;
  const std::vector<accel::MaterialOpacity>& opacities_;
};

}  // namespace tessera::core
