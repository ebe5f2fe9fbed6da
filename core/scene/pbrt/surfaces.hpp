// SPDX-License-Identifier: Apache-2.0
// The materials of shapes: in the scene file emission, opacity and media belong to a shape, and here to its
// material. Not thread-safe.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <tuple>

#include "core/base/error.hpp"
#include "core/media/medium_description.hpp"
#include "core/scene/pbrt/lights.hpp"
#include "core/scene/pbrt/materials.hpp"
#include "core/scene/pbrt/report.hpp"
#include "core/scene/pbrt/texture_baker.hpp"
#include "core/scene/pbrt/texture_node.hpp"

namespace tessera::core::pbrt {

// What the surface of a shape depends on.
struct Surface {
  int material = 0;                          // of Materials
  std::shared_ptr<const AreaLight> light{};  // null if it does not emit
  TexturePtr alpha{};                        // null if it is opaque
  MediumInterface media{};
};

class Surfaces {
 public:
  // The arguments must outlive this object.
  Surfaces(SceneBuilder& builder, const Report& report, const Materials& materials, TextureBaker& baker)
      : builder_(builder), report_(report), materials_(materials), baker_(baker) {}

  // The index of the material in the scene. `area` is that of the shape, for lights of a given power. nullopt
  // for a surface that has no effect.
  Result<std::optional<std::uint32_t>> material(Surface surface, double area, const Place& place);
  // Whether it depends on texture coordinates.
  bool is_textured(const Surface& surface) const;
  // Whether it matters which of its sides is the front.
  bool has_sides(const Surface& surface) const;
  // Whether the outside of its material is the denser side.
  bool is_reversed(const Surface& surface) const { return materials_.is_reversed(surface.material); }

 private:
  Result<Material> make(const Surface& surface, double area, const Place& place);

  SceneBuilder& builder_;
  const Report& report_;
  const Materials& materials_;
  TextureBaker& baker_;
  using Key = std::tuple<int, const AreaLight*, const TextureNode*, int, int, double>;
  struct Made {
    Surface surface;  // keeps the pointers of the key alive
    std::uint32_t index;
  };
  std::map<Key, Made> made_;
};

}  // namespace tessera::core::pbrt
