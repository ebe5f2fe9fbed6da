#include "core/integrators/vertex.hpp"

#include "core/integrators/shading_normal.hpp"
#include "core/materials/normal_map.hpp"

namespace tessera::core {
namespace {

bool is_outside(const SurfacePoint& surface, Vec3 wo) {
  return dot(surface.geometric_normal, wo) >= 0;
}

// The outward normal that the surface is shaded with, interpolated and bent by the material's map.
Vec3 outward_normal(const Scene& scene, const Material& material, const Hit& hit,
                    const SurfacePoint& surface) {
  if (material.normal_map.texture < 0) return surface.shading_normal;
  const auto [along_u, along_v] = scene.primitives().tangents(hit, surface);
  return bend_by_map(material.normal_map, scene.textures(), surface.uv, surface.shading_normal, along_u,
                     along_v);
}

// The same on the side of wo, and fit to be shaded with. `side` is the true normal there.
Vec3 shading_normal(Vec3 outward, bool outside, const MaterialModel& model, Vec3 side, Vec3 wo) {
  const Vec3 above = bend_above(outside ? outward : -outward, side);
  const Vec3 seen = bend_toward_viewer(above, wo);
  return std::holds_alternative<Lambert>(model) ? seen : bend_for_reflection(seen, side, wo);
}

}  // namespace

PathVertex::PathVertex(const Scene& scene, const Ray& ray, const Hit& hit)
    : PathVertex(scene, scene.material_of(hit), hit, scene.primitives().surface(ray, hit),
                 normalize(-ray.direction)) {}

PathVertex::PathVertex(const Scene& scene, const Material& material, const Hit& hit,
                       const SurfacePoint& surface, Vec3 wo)
    : surface_(surface),
      wo_(wo),
      side_normal_(is_outside(surface, wo) ? surface.geometric_normal : -surface.geometric_normal),
      frame_(Frame::around(shading_normal(outward_normal(scene, material, hit, surface),
                                          is_outside(surface, wo), material.model, side_normal_, wo))),
      wo_local_(frame_.to_local(wo)),
      bsdf_(material, scene.textures(), surface.uv, is_outside(surface, wo)) {}

// Where the shading normal and the true one disagree on the side of wi, neither reflection nor transmission
// leads there.
float PathVertex::side_factor(Vec3 wi, Vec3 wi_local) const {
  if (wi_local.z > 0) return smooth_terminator(frame_.normal, side_normal_, wi);
  return dot(wi, side_normal_) < 0 ? 1.0f : 0.0f;
}

BsdfValue PathVertex::evaluate(Vec3 wi) const {
  const Vec3 wi_local = frame_.to_local(wi);
  const BsdfValue scattered = bsdf_.evaluate(wo_local_, wi_local);
  const float factor = side_factor(wi, wi_local);
  return {factor > 0 ? scattered.value * factor : Rgb{}, scattered.pdf};
}

std::optional<PathVertex::Scattered> PathVertex::sample(Vec2 u, float u_lobe) const {
  const auto local = bsdf_.sample(wo_local_, u, u_lobe);
  if (!local) return std::nullopt;
  if (local->delta) return delta_to_world(*local);
  const Vec3 wi = normalize(frame_.to_world(local->wi_local));
  const float factor = side_factor(wi, local->wi_local);
  if (!(factor > 0)) return std::nullopt;
  return Scattered{wi, local->weight * factor, local->pdf, false, local->eta};
}

PathVertex::Scattered PathVertex::delta_to_world(const BsdfSample& local) const {
  const Vec3 wi = normalize(frame_.to_world(local.wi_local));
  return {bend_above(wi, local.transmitted ? -side_normal_ : side_normal_), local.weight, local.pdf, true,
          local.eta};
}

std::array<std::optional<PathVertex::Scattered>, 2> PathVertex::delta_branches() const {
  std::array<std::optional<Scattered>, 2> branches;
  const auto local = bsdf_.delta_branches(wo_local_);
  for (std::size_t i = 0; i < branches.size(); ++i)
    if (local[i]) branches[i] = delta_to_world(*local[i]);
  return branches;
}

Ray PathVertex::ray_along(Vec3 wi) const {
  return Ray{offset_origin(surface_, wi), wi};
}

Ray PathVertex::ray_to(const SurfacePoint& other) const {
  const Vec3 origin = offset_origin(surface_, other.position - surface_.position);
  const Vec3 target = offset_origin(other, surface_.position - other.position);
  return Ray{origin, target - origin, 1};
}

Ray PathVertex::ray_toward(const LightSample& light) const {
  return light.point ? ray_to(*light.point) : ray_along(light.wi);
}

}  // namespace tessera::core
