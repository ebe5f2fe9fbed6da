// SPDX-License-Identifier: Apache-2.0
#include "core/integrators/vertex_batch.hpp"

#include "core/base/overloaded.hpp"
#include "core/materials/limits.hpp"
#include "core/shading/model_at.hpp"

namespace tessera::core {
namespace {

using Materials = SurfaceBatch::Materials;

Mask8 f0_is_base_color(const Materials& glossy) {
  unsigned lanes = 0;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane)
    lanes |= (f0_is_base_color(*std::get_if<CookTorrance>(&glossy[lane]->model)) ? 1u : 0u) << lane;
  return Mask8::from_bits(lanes);
}

// The BSDFs of glossy materials, with their textures evaluated.
CookTorranceBsdfOf<Float8> glossy_bsdfs(const SurfaceBatch& batch) {
  const Materials& materials = batch.materials;
  const std::vector<Texture>& textures = batch.scene.textures();
  const UvSetsOf<Float8> uv = batch.uv_sets();
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
  if (batch.scene.primitives().has_vertex_colors()) {
    const RgbOf<Float8> tint = batch.tints();
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

void MixedBsdfs::turn_coat(Mask8 lanes, const FrameOf<Float8>& axes, Vec3Of<Float8> wo_local) {
  const Vec3Lanes tangents(axes.tangent), bitangents(axes.bitangent), normals(axes.normal), wo(wo_local);
  for (std::size_t lane = 0; lane < kLaneCount; ++lane)
    if (bsdfs_[lane] && (lanes.bits() >> lane & 1) != 0)
      bsdfs_[lane]->turn_coat(true, {tangents[lane], bitangents[lane], normals[lane]}, wo[lane]);
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

BsdfSampleOf<Float8> MixedBsdfs::sample(Vec3Of<Float8> wo_local, Vec2Of<Float8> u, Float8 u_lobe) const {
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

Kernel kernel_of(const Material& material) {
  if (material.sampling == Sampling::kUniform) return Kernel::kMixed;
  return std::visit(
      Overloaded{
          [](const Lambert&) { return Kernel::kDiffuse; },
          [](const CookTorrance&) { return Kernel::kGlossy; }, [](const Phong&) { return Kernel::kPhong; },
          [](const Mirror&) { return Kernel::kSpecular; },
          [](const Glass& m) {
            return m.microfacets.is_correlated_ggx() ? Kernel::kSpecular : Kernel::kMixed;
          },
          [&](const ThinDielectric&) {
            return passes_straight(material) ? Kernel::kMixed : Kernel::kLayered;
          },
          [&](const auto&) { return has_vector_form(material.model) ? Kernel::kLayered : Kernel::kMixed; }},
      material.model);
}

DiffuseVertices diffuse_vertices(const SurfaceBatch& batch) {
  std::array<const ColorParameter*, kLaneCount> albedos;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane)
    albedos[lane] = &std::get_if<Lambert>(&batch.materials[lane]->model)->albedo;
  RgbOf<Float8> albedo = evaluate(albedos, batch.scene.textures(), batch.uv_sets());
  if (batch.scene.primitives().has_vertex_colors()) albedo = albedo * batch.tints();
  return {batch, batch.side.shading_normal(batch.outward_normals(), batch.wo), {albedo}};
}

namespace {

// Outward normals as the shading normals of surfaces with highlights.
Vec3Of<Float8> valid_reflection_normals(const SurfaceBatch& batch, Vec3Of<Float8> outward) {
  return ensure_valid_reflection(batch.side.shading_normal(outward, batch.wo), batch.side.normal, batch.wo);
}
Vec3Of<Float8> glossy_normals(const SurfaceBatch& batch) {
  return valid_reflection_normals(batch, batch.outward_normals());
}

}  // namespace

GlossyVertices glossy_vertices(const SurfaceBatch& batch) {
  return {batch, glossy_normals(batch), glossy_bsdfs(batch)};
}

PhongVertices phong_vertices(const SurfaceBatch& batch) {
  std::array<const Phong*, kLaneCount> phongs;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane)
    phongs[lane] = std::get_if<Phong>(&batch.materials[lane]->model);
  const MaterialPointOf<Float8> at = batch.material_point();
  const ModelAt<Float8, Phong> model(phongs, at);
  const RgbOf<Float8> diffuse = model(&Phong::diffuse) * at.tint, specular = model(&Phong::specular);
  const RgbOf<Float8> scale = normalize_energy(diffuse, specular);
  return {batch,
          glossy_normals(batch),
          {diffuse * scale, specular * scale, clamp_between(model(&Phong::exponent), 0.0f, kMaxExponent),
           model.holds([](const Phong& m) { return m.lobe == PhongLobe::kNPlus2; })}};
}

SpecularVertices specular_vertices(const SurfaceBatch& batch) {
  static const Glass kNoGlass;
  std::array<const Glass*, kLaneCount> glasses;
  std::array<const ColorParameter*, kLaneCount> reflectances;
  unsigned mirrors = 0;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    const MaterialModel& model = batch.materials[lane]->model;
    const auto* mirror = std::get_if<Mirror>(&model);
    glasses[lane] = mirror != nullptr ? &kNoGlass : std::get_if<Glass>(&model);
    reflectances[lane] = mirror != nullptr ? &mirror->reflectance : &glasses[lane]->reflectance;
    mirrors |= (mirror != nullptr ? 1u : 0u) << lane;
  }
  const MaterialPointOf<Float8> at = batch.material_point();
  const ModelAt<Float8, Glass> glass(glasses, at);
  const Float8 ior = clamp_between(glass(&Glass::ior), 1.0f, kMaxIor), eta = select(at.outside, ior, 1 / ior);
  const Float8 alpha = squared_roughness(glass(&Glass::roughness));
  const RgbOf<Float8> reflectance = evaluate(reflectances, at.textures, at.uv);
  const RgbOf<Float8> transmittance = glass(&Glass::transmittance);
  const DielectricFresnelOf<Float8> fresnel{
      glass.holds([](const Glass& m) { return m.fresnel == DielectricFresnel::kSchlick; }),
      glass.holds([](const Glass& m) { return m.fresnel == DielectricFresnel::kNone; })};
  const Mask8 is_mirror = Mask8::from_bits(mirrors);
  const Mask8 is_smooth = (alpha < kMinAlpha) | (ior - 1 < kMinBending);
  return {batch,
          glossy_normals(batch),
          {is_mirror,
           !(is_mirror | is_smooth),
           {reflectance * at.tint},
           {eta, fresnel, reflectance, transmittance},
           {GgxOf<Float8>(larger(alpha, Float8(kMinAlpha))), eta, fresnel, reflectance, transmittance}}};
}

namespace {

// Gives the coats in a set of lanes frames of their own.
template <typename Vertices>
void turn_coats(const SurfaceBatch& batch, const SurfacePoints& points, unsigned lanes, Vertices& vertices) {
  Vec3Lanes outward(batch.surface.shading_normal), tangents{};
  unsigned mapped = 0;  // those with normals of their own
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    if ((lanes >> lane & 1) == 0) continue;
    const Principled& coated = *with_own_coat_frame(batch.materials[lane]->model);
    const Hit& hit = *batch.hits[lane];
    tangents.set(lane, highlight_tangent(batch.scene, coated.coat_tangent, hit, points[lane]));
    if (coated.geometry_coat_normal.texture < 0) continue;
    mapped |= 1u << lane;
    outward.set(lane, mapped_normal(batch.scene, coated.geometry_coat_normal, hit, points[lane]));
  }
  const Vec3Of<Float8> of_maps = valid_reflection_normals(batch, outward.all());
  vertices.turn_coat(Mask8::from_bits(lanes),
                     select(Mask8::from_bits(mapped), of_maps, vertices.shading_normal()), tangents.all());
}

// Turns the highlights, and the coats that have a frame of their own, of the first `count` lanes.
template <typename Vertices>
void orient_microfacets(const SurfaceBatch& batch, std::size_t count, Vertices& vertices) {
  const SurfacePoints points(batch.surface);
  Vec3Lanes tangents{};
  unsigned anisotropic = 0, coats = 0;
  for (std::size_t lane = 0; lane < count; ++lane) {
    const MaterialModel& model = batch.materials[lane]->model;
    coats |= (with_own_coat_frame(model) != nullptr ? 1u : 0u) << lane;
    const TangentDirection* direction = highlight_direction(model);
    if (direction == nullptr) continue;
    anisotropic |= 1u << lane;
    tangents.set(lane, highlight_tangent(batch.scene, *direction, *batch.hits[lane], points[lane]));
  }
  if (anisotropic != 0) vertices.orient(tangents.all());
  if (coats != 0) turn_coats(batch, points, coats, vertices);
}

}  // namespace

LayeredVertices layered_vertices(const SurfaceBatch& batch) {
  ModelPointers models;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) models[lane] = &batch.materials[lane]->model;
  LayeredVertices vertices(batch, glossy_normals(batch), closures_of(models, batch.material_point()));
  orient_microfacets(batch, kLaneCount, vertices);
  return vertices;
}

MixedVertices mixed_vertices(const SurfaceBatch& batch, std::size_t count) {
  const Scene& scene = batch.scene;
  const SurfacePoints points(batch.surface);
  const RgbLanes tints(batch.tints());
  MixedBsdfs bsdfs;
  unsigned diffuse = 0;
  for (std::size_t lane = 0; lane < count; ++lane) {
    const Material& material = *batch.materials[lane];
    const SurfacePoint point = points[lane];
    if (std::holds_alternative<Lambert>(material.model)) diffuse |= 1u << lane;
    bsdfs.set(lane, Bsdf(material, scene.textures(), uv_sets_at(scene, *batch.hits[lane], point),
                         (batch.side.outside.bits() >> lane & 1) != 0, tints[lane]));
  }
  const Vec3Of<Float8> seen = batch.side.shading_normal(batch.outward_normals(), batch.wo);
  const Vec3Of<Float8> bent =
      select(Mask8::from_bits(diffuse), seen, ensure_valid_reflection(seen, batch.side.normal, batch.wo));
  MixedVertices vertices(batch, bent, bsdfs);
  orient_microfacets(batch, count, vertices);
  return vertices;
}

}  // namespace tessera::core
