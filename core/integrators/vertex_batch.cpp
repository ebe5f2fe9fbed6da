// SPDX-License-Identifier: Apache-2.0
#include "core/integrators/vertex_batch.hpp"

#include <algorithm>
#include <bit>

#include "core/materials/limits.hpp"
#include "core/materials/normal_map.hpp"

namespace tessera::core {
namespace {

using Rays = std::array<const Ray*, kLaneCount>;
using Hits = std::array<const Hit*, kLaneCount>;
constexpr unsigned kAllLanes = (1u << kLaneCount) - 1;

Vec3Of<Float8> toward_origins(const Rays& rays) {
  Vec3Lanes directions;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) directions.set(lane, rays[lane]->direction);
  return normalize(-directions.all());
}

// Surface points that are computed one by one.
class SurfaceLanes {
 public:
  explicit SurfaceLanes(const SurfacePointOf<Float8>& all)
      : position_(all.position),
        position_error_(all.position_error),
        geometric_normal_(all.geometric_normal),
        shading_normal_(all.shading_normal),
        u_(all.uv.x),
        v_(all.uv.y) {}

  void set(std::size_t lane, const SurfacePoint& point) {
    position_.set(lane, point.position);
    position_error_.set(lane, point.position_error);
    geometric_normal_.set(lane, point.geometric_normal);
    shading_normal_.set(lane, point.shading_normal);
    u_.set(lane, point.uv.x);
    v_.set(lane, point.uv.y);
  }
  SurfacePoint operator[](std::size_t lane) const {
    return {position_[lane],
            position_error_[lane],
            geometric_normal_[lane],
            shading_normal_[lane],
            {u_[lane], v_[lane]}};
  }
  SurfacePointOf<Float8> all() const {
    return {position_.all(),
            position_error_.all(),
            geometric_normal_.all(),
            shading_normal_.all(),
            {u_.all(), v_.all()}};
  }

 private:
  Vec3Lanes position_, position_error_, geometric_normal_, shading_normal_;
  FloatLanes u_, v_;
};

SurfacePointOf<Float8> select(Mask8 mask, const SurfacePointOf<Float8>& a, const SurfacePointOf<Float8>& b) {
  return {select(mask, a.position, b.position),
          select(mask, a.position_error, b.position_error),
          select(mask, a.geometric_normal, b.geometric_normal),
          select(mask, a.shading_normal, b.shading_normal),
          {select(mask, a.uv.x, b.uv.x), select(mask, a.uv.y, b.uv.y)}};
}

// Fills the lanes outside a set with one of the set's lanes.
template <typename Pointers>
Pointers filled(Pointers all, unsigned set) {
  const auto some = static_cast<std::size_t>(std::countr_zero(set));
  for (std::size_t lane = 0; lane < kLaneCount; ++lane)
    if ((set >> lane & 1) == 0) all[lane] = all[some];
  return all;
}

SurfacePointOf<Float8> surfaces(const Primitives& primitives, const Rays& rays, const Hits& hits) {
  unsigned triangles = 0, spheres = 0;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    triangles |= (primitives.is_plain_triangle(*hits[lane]) ? 1u : 0u) << lane;
    spheres |= (primitives.is_plain_sphere(*hits[lane]) ? 1u : 0u) << lane;
  }
  SurfacePointOf<Float8> all;
  if (triangles != 0) all = primitives.triangle_surfaces(filled(hits, triangles));
  if (spheres != 0)
    all = select(Mask8::from_bits(spheres),
                 primitives.sphere_surfaces(filled(rays, spheres), filled(hits, spheres)), all);
  const unsigned others = kAllLanes & ~(triangles | spheres);
  if (others == 0) return all;
  SurfaceLanes lanes(all);
  for (std::size_t lane = 0; lane < kLaneCount; ++lane)
    if ((others >> lane & 1) != 0) lanes.set(lane, primitives.surface(*rays[lane], *hits[lane]));
  return lanes.all();
}

using Materials = std::array<const Material*, kLaneCount>;

// outward_normal() for eight triangles.
Vec3Of<Float8> outward_normals(const Scene& scene, const Materials& materials, const Hits& hits,
                               const SurfacePointOf<Float8>& surface) {
  std::array<const Texture*, kLaneCount> maps{};
  FloatLanes strength{};
  Vec3Lanes along_u{}, along_v{};  // zero without a map: normals then stay unchanged
  const Texture* some_map = nullptr;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    const NormalMap& map = materials[lane]->normal_map;
    if (map.texture < 0) continue;
    some_map = maps[lane] = &scene.textures()[static_cast<std::size_t>(map.texture)];
    strength.set(lane, map.strength);
    const auto [of_u, of_v] = image_tangents(scene, *some_map, *hits[lane], {});
    along_u.set(lane, of_u);
    along_v.set(lane, of_v);
  }
  if (!some_map) return surface.shading_normal;
  std::replace(maps.begin(), maps.end(), static_cast<const Texture*>(nullptr), some_map);
  return perturb_by_normal_map(Texture::evaluate(maps, surface.uv), strength.all(), surface.shading_normal,
                               along_u.all(), along_v.all());
}

Mask8 f0_is_base_color(const Materials& glossy) {
  unsigned lanes = 0;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane)
    lanes |= (f0_is_base_color(*std::get_if<CookTorrance>(&glossy[lane]->model)) ? 1u : 0u) << lane;
  return Mask8::from_bits(lanes);
}

// The BSDFs of eight glossy materials, with their textures evaluated.
CookTorranceBsdfOf<Float8> glossy_bsdfs(const Scene& scene, const Materials& materials, const Hits& hits,
                                        Vec2Of<Float8> uv) {
  const std::vector<Texture>& textures = scene.textures();
  std::array<const ColorParameter*, kLaneCount> diffuse, specular, f0;
  std::array<const ScalarParameter*, kLaneCount> roughness;
  RgbLanes eta{}, k{};
  unsigned metal = 0, schlick_masking = 0, half_vector = 0;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    const auto& model = *std::get_if<CookTorrance>(&materials[lane]->model);
    diffuse[lane] = &model.diffuse, specular[lane] = &model.specular, f0[lane] = &model.f0;
    roughness[lane] = &model.roughness;
    schlick_masking |= (model.masking == Masking::kSchlick ? 1u : 0u) << lane;
    half_vector |= (materials[lane]->sampling == Sampling::kHalfVector ? 1u : 0u) << lane;
    if (!model.conductor) continue;
    metal |= 1u << lane;
    const ComplexIndex index = complex_index(*model.conductor);
    eta.set(lane, index.eta), k.set(lane, index.k);
  }
  RgbOf<Float8> kd = evaluate(diffuse, textures, uv), r0 = evaluate(f0, textures, uv);
  if (scene.primitives().has_vertex_colors()) {
    const RgbOf<Float8> tint = scene.primitives().triangle_colors(hits);
    kd = kd * tint;
    r0 = select(f0_is_base_color(materials), r0 * tint, r0);
  }
  const RgbOf<Float8> ks = evaluate(specular, textures, uv);
  const RgbOf<Float8> scale = normalize_energy(kd, ks);
  return {kd * scale,
          ks * scale,
          Mask8::from_bits(metal),
          r0,
          eta.all(),
          k.all(),
          rough_ggx(evaluate(roughness, textures, uv)),
          Mask8::from_bits(schlick_masking),
          Mask8::from_bits(half_vector)};
}

}  // namespace

void MixedBsdfs::set(std::size_t lane, const Bsdf& bsdf) {
  bsdfs_[lane] = bsdf;
  delta_ |= (bsdf.is_delta() ? 1u : 0u) << lane;
  transmits_ |= (bsdf.transmits() ? 1u : 0u) << lane;
}

void MixedBsdfs::scale_diffuse(Float8 factor) {
  const FloatLanes factors(factor);
  for (std::size_t lane = 0; lane < kLaneCount; ++lane)
    if (bsdfs_[lane]) bsdfs_[lane]->scale_diffuse(factors[lane]);
}

void MixedBsdfs::orient(Vec3Of<Float8> tangents_local) {
  const Vec3Lanes tangents(tangents_local);
  for (std::size_t lane = 0; lane < kLaneCount; ++lane)
    if (bsdfs_[lane]) bsdfs_[lane]->orient(tangents[lane]);
}

BsdfValueOf<Float8> MixedBsdfs::evaluate(Vec3Of<Float8> wo_local, Vec3Of<Float8> wi_local,
                                         Float8 diffuse_cos) const {
  const Vec3Lanes wo(wo_local), wi(wi_local);
  const FloatLanes diffuse_coses(diffuse_cos);
  RgbLanes value{};
  FloatLanes pdf{};
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    if (!bsdfs_[lane] || wi[lane] == Vec3{}) continue;
    const BsdfValue one = bsdfs_[lane]->evaluate(wo[lane], wi[lane], diffuse_coses[lane]);
    value.set(lane, one.value);
    pdf.set(lane, one.pdf);
  }
  return {value.all(), pdf.all()};
}

BsdfSamples MixedBsdfs::sample(Vec3Of<Float8> wo_local, Vec2Of<Float8> u, Float8 u_lobe) const {
  const Vec3Lanes wo(wo_local);
  const FloatLanes u_x(u.x), u_y(u.y), lobe(u_lobe);
  Vec3Lanes wi{};
  RgbLanes weight{};
  FloatLanes pdf{}, eta{};
  unsigned found = 0, delta = 0, transmitted = 0;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    if (!bsdfs_[lane]) continue;
    const auto one = bsdfs_[lane]->sample(wo[lane], {u_x[lane], u_y[lane]}, lobe[lane]);
    if (!one) continue;
    found |= 1u << lane;
    delta |= (one->delta ? 1u : 0u) << lane;
    transmitted |= (one->transmitted ? 1u : 0u) << lane;
    wi.set(lane, one->wi_local);
    weight.set(lane, one->weight);
    pdf.set(lane, one->pdf);
    eta.set(lane, one->eta);
  }
  return {Mask8::from_bits(found),
          Mask8::from_bits(delta),
          Mask8::from_bits(transmitted),
          wi.all(),
          weight.all(),
          pdf.all(),
          eta.all()};
}

bool is_diffuse(const Material& material) {
  return std::holds_alternative<Lambert>(material.model) && material.normal_map.texture < 0 &&
         material.bump.texture < 0 && material.sampling != Sampling::kUniform;
}

DiffuseVertices diffuse_vertices(const Scene& scene, const Rays& rays, const Hits& hits) {
  const Vec3Of<Float8> wo = toward_origins(rays);
  const SurfacePointOf<Float8> surface = scene.primitives().triangle_surfaces(hits);
  const ViewedSide<Float8> side(surface, wo);
  std::array<const ColorParameter*, kLaneCount> albedos;
  unsigned one_sided = 0;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    const Material& material = scene.material_of(*hits[lane]);
    albedos[lane] = &std::get_if<Lambert>(&material.model)->albedo;
    one_sided |= (material.two_sided ? 0u : 1u) << lane;
  }
  RgbOf<Float8> albedo = evaluate(albedos, scene.textures(), surface.uv);
  if (scene.primitives().has_vertex_colors()) albedo = albedo * scene.primitives().triangle_colors(hits);
  if (one_sided != 0) albedo = select(side.outside | !Mask8::from_bits(one_sided), albedo, RgbOf<Float8>{});
  return {surface, wo, side.normal, side.shading_normal(surface.shading_normal, wo), {{albedo}}};
}

bool is_glossy(const Material& material) {
  return std::holds_alternative<CookTorrance>(material.model) && material.bump.texture < 0 &&
         material.sampling != Sampling::kUniform && material.two_sided;
}

GlossyVertices glossy_vertices(const Scene& scene, const Rays& rays, const Hits& hits) {
  const Vec3Of<Float8> wo = toward_origins(rays);
  const SurfacePointOf<Float8> surface = scene.primitives().triangle_surfaces(hits);
  const ViewedSide<Float8> side(surface, wo);
  Materials materials;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) materials[lane] = &scene.material_of(*hits[lane]);
  const Vec3Of<Float8> outward = outward_normals(scene, materials, hits, surface);
  const Vec3Of<Float8> seen = side.shading_normal(outward, wo);
  return {surface,
          wo,
          side.normal,
          ensure_valid_reflection(seen, side.normal, wo),
          {glossy_bsdfs(scene, materials, hits, surface.uv)}};
}

MixedVertices mixed_vertices(const Scene& scene, const Rays& rays, const Hits& hits, std::size_t count) {
  const Vec3Of<Float8> wo = toward_origins(rays);
  const SurfacePointOf<Float8> surface = surfaces(scene.primitives(), rays, hits);
  const ViewedSide<Float8> side(surface, wo);
  Vec3Lanes outward(surface.shading_normal);
  const FloatLanes u(surface.uv.x), v(surface.uv.y);
  MixedBsdfs bsdfs;
  unsigned diffuse = 0, anisotropic = 0;
  Vec3Lanes tangents{};
  for (std::size_t lane = 0; lane < count; ++lane) {
    const Material& hit_material = scene.material_of(*hits[lane]);
    const bool is_blend = std::holds_alternative<Blend>(hit_material.model);
    const Material& material =
        is_blend ? scatterer_of(scene, *hits[lane], SurfaceLanes(surface)[lane], Vec3Lanes(wo)[lane])
                 : hit_material;
    if (material.normal_map.texture >= 0 || material.bump.texture >= 0)
      outward.set(lane, outward_normal(scene, material, *hits[lane], SurfaceLanes(surface)[lane]));
    if (std::holds_alternative<Lambert>(material.model)) diffuse |= 1u << lane;
    if (is_anisotropic(material.model)) {
      anisotropic |= 1u << lane;
      tangents.set(lane, highlight_tangent(scene, *hits[lane], SurfaceLanes(surface)[lane]));
    }
    bsdfs.set(lane,
              Bsdf(material, scene.textures(), {u[lane], v[lane]}, (side.outside.bits() >> lane & 1) != 0,
                   scene.primitives().vertex_color(*hits[lane])));
  }
  const Vec3Of<Float8> seen = side.shading_normal(outward.all(), wo);
  const Vec3Of<Float8> bent =
      select(Mask8::from_bits(diffuse), seen, ensure_valid_reflection(seen, side.normal, wo));
  MixedVertices vertices(surface, wo, side.normal, bent, bsdfs);
  if (anisotropic != 0) vertices.orient(tangents.all());
  return vertices;
}

}  // namespace tessera::core
