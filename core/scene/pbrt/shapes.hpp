// SPDX-License-Identifier: Apache-2.0
// The shapes of a scene. Not thread-safe.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/base/error.hpp"
#include "core/scene/description.hpp"
#include "core/scene/import/scene_builder.hpp"
#include "core/scene/pbrt/matrix.hpp"
#include "core/scene/pbrt/report.hpp"
#include "core/scene/pbrt/surfaces.hpp"
#include "core/scene/pbrt/textures.hpp"

namespace tessera::core::pbrt {

// The state of the file where a shape stands.
struct ShapePlacement {
  Matrix to_world;
  bool reverse_orientation = false;
  Surface surface;  // without the alpha of the shape
  std::optional<std::uint32_t> object{};
};

class Shapes {
 public:
  // The arguments must outlive this object.
  Shapes(SceneBuilder& builder, const Report& report, Surfaces& surfaces, Textures& textures)
      : builder_(builder), report_(report), surfaces_(surfaces), textures_(textures) {}

  // The directive Shape. Shapes that are not supported are left out, with a warning. Fails beyond the limits.
  Status add(const std::string& kind, const Parameters& p, ShapePlacement placement);

 private:
  void turn_inside_out(const Parameters& p, ShapePlacement& at);
  Status add_sphere(const Parameters& p, const ShapePlacement& at);
  Status add_disk(const Parameters& p, const ShapePlacement& at);
  Status add_cylinder(const Parameters& p, const ShapePlacement& at);
  Status add_triangles(const Parameters& p, const ShapePlacement& at);
  Status add_ply(const Parameters& p, const ShapePlacement& at);
  Status add_patches(const Parameters& p, const ShapePlacement& at);
  Status add_curve(const Parameters& p, const ShapePlacement& at);
  Status add_subdivision(const Parameters& p, const ShapePlacement& at);
  // `shapes` is the number of pbrt's shapes, each of which is a light; without it, each triangle is one.
  Status add_mesh(MeshDescription mesh, const Parameters& p, const ShapePlacement& at,
                  std::optional<std::size_t> shapes = {});
  // Adds the shape if its surface has an effect.
  template <typename Description>
  Status add_analytic(Description shape, double area, const Parameters& p, const ShapePlacement& at);

  SceneBuilder& builder_;
  const Report& report_;
  Surfaces& surfaces_;
  Textures& textures_;
};

}  // namespace tessera::core::pbrt
