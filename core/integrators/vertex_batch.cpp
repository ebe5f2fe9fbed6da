// SPDX-License-Identifier: Apache-2.0
#include "core/integrators/vertex_batch.hpp"

#include "core/base/overloaded.hpp"
#include "core/shading/bsdf_at.hpp"
#include "core/shading/layered_materials.hpp"

namespace tessera::core::integrators {
namespace {

// The models of a batch, which must all be a Model.
template <typename Model>
ModelAt<FloatN, Model> models_at(const SurfaceBatch& batch, const MaterialPointOf<FloatN>& at) {
  return {models_of<Model>(batch.materials), at};
}

Vec3Of<FloatN> diffuse_normals(const SurfaceBatch& batch) {
  return batch.side.shading_normal(batch.outward_normals(), batch.wo);
}

// Outward normals as the shading normals of surfaces with highlights.
Vec3Of<FloatN> valid_reflection_normals(const SurfaceBatch& batch, Vec3Of<FloatN> outward) {
  return ensure_valid_reflection(batch.side.shading_normal(outward, batch.wo), batch.side.normal, batch.wo);
}
Vec3Of<FloatN> glossy_normals(const SurfaceBatch& batch) {
  return valid_reflection_normals(batch, batch.outward_normals());
}

// Gives the coats in a set of lanes frames of their own.
template <typename Vertices>
void turn_coats(const SurfaceBatch& batch, const SurfacePoints& points, unsigned lanes, Vertices& vertices) {
  Vec3Lanes outward(batch.surface.shading_normal), tangents{};
  unsigned mapped = 0;  // those with normals of their own
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    if ((lanes >> lane & 1) == 0) continue;
    const Principled& coated = *with_own_coat_frame(batch.materials[lane]->model);
    const Hit hit = batch.hits[lane];
    tangents.set(lane, highlight_tangent(batch.scene, coated.coat_tangent, hit, points[lane]));
    if (coated.geometry_coat_normal.texture < 0) continue;
    mapped |= 1u << lane;
    outward.set(lane, mapped_normal(batch.scene, coated.geometry_coat_normal, hit, points[lane]));
  }
  const Vec3Of<FloatN> of_maps = valid_reflection_normals(batch, outward.all());
  vertices.turn_coat(MaskN::from_bits(lanes),
                     select(MaskN::from_bits(mapped), of_maps, vertices.shading_normal()), tangents.all());
}

// Turns the highlights, and the coats that have a frame of their own.
template <typename Vertices>
void orient_microfacets(const SurfaceBatch& batch, Vertices& vertices) {
  const SurfacePoints points(batch.surface);
  Vec3Lanes tangents{};
  unsigned anisotropic = 0, coats = 0;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    const MaterialModel& model = batch.materials[lane]->model;
    coats |= (with_own_coat_frame(model) != nullptr ? 1u : 0u) << lane;
    const TangentDirection* direction = highlight_direction(model);
    if (direction == nullptr) continue;
    anisotropic |= 1u << lane;
    tangents.set(lane, highlight_tangent(batch.scene, *direction, batch.hits[lane], points[lane]));
  }
  if (anisotropic != 0) vertices.orient(tangents.all());
  if (coats != 0) turn_coats(batch, points, coats, vertices);
}

shading::ClosureOf<FloatN> closures_at(const SurfaceBatch& batch, const MaterialPointOf<FloatN>& at) {
  return std::visit(
      [&]<typename Model>(const Model&) -> shading::ClosureOf<FloatN> {
        if constexpr (requires(const ModelAt<FloatN, Model>& models) { shading::closure_at(models); })
          return shading::closure_at(models_at<Model>(batch, at));
        return {};
      },
      batch.materials[0]->model);
}

}  // namespace

Kernel kernel_of(const Material& material) {
  const bool is_delta = std::holds_alternative<Mirror>(material.model) ||
                        std::holds_alternative<ThinDielectric>(material.model);
  if (material.sampling == Sampling::kUniform && !is_delta) return Kernel::kGeneral;
  const auto by_facets = [](MicrofacetKind kind, Kernel kernel) {
    return kind.is_correlated_ggx() ? kernel : Kernel::kGeneral;
  };
  return std::visit(Overloaded{
                        [](const Lambert&) { return Kernel::kDiffuse; },
                        [](const CookTorrance&) { return Kernel::kGlossy; },
                        [](const Phong&) { return Kernel::kPhong; },
                        [](const Mirror&) { return Kernel::kSpecular; },
                        [&](const Glass& m) { return by_facets(m.microfacets, Kernel::kSpecular); },
                        [&](const ThinDielectric&) {
                          return passes_straight(material) ? Kernel::kSpecular : Kernel::kLayered;
                        },
                        [](const Hair&) { return Kernel::kGeneral; },
                        [](const Disney&) { return Kernel::kGeneral; },
                        [](const auto&) { return Kernel::kLayered; },
                    },
                    material.model);
}

DiffuseVertices diffuse_vertices(const SurfaceBatch& batch) {
  const MaterialPointOf<FloatN> at = batch.material_point();
  return {batch, diffuse_normals(batch), shading::bsdf_at(models_at<Lambert>(batch, at))};
}

GlossyVertices glossy_vertices(const SurfaceBatch& batch) {
  const MaterialPointOf<FloatN> at = batch.material_point();
  const MaskN half_vector =
      ModelAt<FloatN, Material>(batch.materials, at).holds([](const Material& material) {
        return material.sampling == Sampling::kHalfVector;
      });
  return {batch, glossy_normals(batch), shading::bsdf_at(models_at<CookTorrance>(batch, at), half_vector)};
}

PhongVertices phong_vertices(const SurfaceBatch& batch) {
  const MaterialPointOf<FloatN> at = batch.material_point();
  return {batch, glossy_normals(batch), shading::bsdf_at(models_at<Phong>(batch, at))};
}

SpecularVertices specular_vertices(const SurfaceBatch& batch) {
  return {batch, glossy_normals(batch),
          shading::specular_at<FloatN, GgxOf<FloatN>>(batch.materials, batch.material_point())};
}

LayeredVertices layered_vertices(const SurfaceBatch& batch) {
  LayeredVertices vertices(batch, glossy_normals(batch), closures_at(batch, batch.material_point()));
  orient_microfacets(batch, vertices);
  return vertices;
}

GeneralVertices general_vertices(const SurfaceBatch& batch) {
  const bool diffuse = std::holds_alternative<Lambert>(batch.materials[0]->model);
  GeneralVertices vertices(batch, diffuse ? diffuse_normals(batch) : glossy_normals(batch),
                           shading::BsdfOf<FloatN>(batch.materials, batch.material_point()));
  orient_microfacets(batch, vertices);
  return vertices;
}

}  // namespace tessera::core::integrators
