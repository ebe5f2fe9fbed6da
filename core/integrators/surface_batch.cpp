// SPDX-License-Identifier: Apache-2.0
#include "core/integrators/surface_batch.hpp"

#include <algorithm>

#include "core/materials/bump_map.hpp"
#include "core/materials/normal_map.hpp"

namespace tessera::core::integrators {
namespace {

Vec3Of<FloatN> toward_origins(const RayRows& rays) {
  return normalize(-rays.all(&Ray::direction));
}

}  // namespace

SurfaceBatch::SurfaceBatch(const Scene& of_scene, const RayRows& rays, const HitRows& of_rays,
                           const Materials& at_hits, bool plain_triangles)
    : scene(of_scene),
      hits(of_rays),
      materials(at_hits),
      surface(plain_triangles ? scene.primitives().triangle_surfaces(hits)
                              : scene.primitives().surfaces(rays, hits)),
      wo(toward_origins(rays)),
      side(surface, wo) {}

RgbOf<FloatN> SurfaceBatch::tints() const {
  if (!scene.primitives().has_vertex_colors()) return RgbOf<FloatN>::gray(1.0f);
  return scene.primitives().vertex_colors(hits);
}

MaskN SurfaceBatch::black_backs() const {
  unsigned one_sided = 0;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane)
    one_sided |= (is_one_sided(*materials[lane]) ? 1u : 0u) << lane;
  if (one_sided == 0) return false;
  return MaskN::from_bits(one_sided) & !side.outside;
}

MaskN SurfaceBatch::plain_normals() const {
  unsigned plain = 0;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane)
    plain |= (materials[lane]->shading_normals == ShadingNormals::kPlain ? 1u : 0u) << lane;
  return MaskN::from_bits(plain);
}

Vec3Of<FloatN> SurfaceBatch::outward_normals() const {
  unsigned mapped = 0, with_bumps = 0;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    mapped |= (materials[lane]->normal_map.texture >= 0 ? 1u : 0u) << lane;
    with_bumps |= (materials[lane]->bump.texture >= 0 ? 1u : 0u) << lane;
  }
  const Vec3Of<FloatN> normals = mapped == 0 ? surface.shading_normal : normal_mapped();
  return with_bumps == 0 ? normals : bumped(normals);
}

// The tangents are zero in lanes without a map, whose normals then stay unchanged.
Vec3Of<FloatN> SurfaceBatch::normal_mapped() const {
  const SurfacePoints points(surface);
  std::array<const Texture*, kLaneCount> maps{};
  FloatLanes strength{};
  Vec3Lanes along_u{}, along_v{};
  const Texture* some_map = nullptr;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    const NormalMap& map = materials[lane]->normal_map;
    if (map.texture < 0) continue;
    some_map = maps[lane] = &scene.textures()[static_cast<std::size_t>(map.texture)];
    strength.set(lane, map.strength);
    const auto [of_u, of_v] = image_tangents(scene, *some_map, hits[lane], points[lane]);
    along_u.set(lane, of_u);
    along_v.set(lane, of_v);
  }
  std::replace(maps.begin(), maps.end(), static_cast<const Texture*>(nullptr), some_map);
  return perturb_by_normal_map(Texture::evaluate(maps, uv_sets()), strength.all(), surface.shading_normal,
                               along_u.all(), along_v.all());
}

Vec3Of<FloatN> SurfaceBatch::bumped(Vec3Of<FloatN> normals) const {
  const SurfacePoints points(surface);
  Vec3Lanes tilted(normals);
  for (std::size_t lane = 0; lane < kLaneCount; ++lane)
    if (materials[lane]->bump.texture >= 0)
      tilted.set(lane, bumped_normal(scene, *materials[lane], hits[lane], points[lane], tilted[lane]));
  return tilted.all();
}

}  // namespace tessera::core::integrators
