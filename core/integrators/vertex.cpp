#include "core/integrators/vertex.hpp"

namespace tessera::core {
namespace {

// Interpolated normals lean away from the viewer near silhouettes. There they are bent back, just far enough
// that the viewer is above the surface; without this, such places would be black.
Vec3 bend_toward(Vec3 shading_normal, Vec3 wo) {
  constexpr float kMinCos = 1e-4f;
  const float cos_o = dot(shading_normal, wo);
  return cos_o >= kMinCos ? shading_normal : normalize(shading_normal + wo * (kMinCos - cos_o));
}

// Mirrored and refracted directions are found with the shading normal and may end on the wrong side of the
// true surface; they are bent back to graze it. `side` is the true normal on the side they should be on.
Vec3 bend_above(Vec3 wi, Vec3 side) {
  constexpr float kMinCos = 1e-4f;
  const float cos_i = dot(wi, side);
  return cos_i >= kMinCos ? wi : normalize(wi + side * (kMinCos - cos_i));
}

bool is_outside(const SurfacePoint& surface, Vec3 wo) {
  return dot(surface.geometric_normal, wo) >= 0;
}

}  // namespace

PathVertex::PathVertex(const Scene& scene, const Ray& ray, const Hit& hit)
    : surface_(scene.primitives().surface(ray, hit)),
      wo_(normalize(-ray.direction)),
      side_normal_(is_outside(surface_, wo_) ? surface_.geometric_normal : -surface_.geometric_normal),
      frame_(Frame::around(bend_toward(face_toward(surface_.shading_normal, side_normal_), wo_))),
      bsdf_(scene.material_of(hit.primitive).model, scene.textures(), surface_.uv,
            is_outside(surface_, wo_)) {}

Rgb PathVertex::evaluate(Vec3 wi) const {
  return same_side(wi) ? bsdf_.evaluate(frame_.to_local(wo_), frame_.to_local(wi)) : Rgb{};
}

float PathVertex::pdf(Vec3 wi) const {
  return bsdf_.pdf(frame_.to_local(wo_), frame_.to_local(wi));
}

std::optional<PathVertex::Scattered> PathVertex::sample(Vec2 u, float u_lobe) const {
  const auto local = bsdf_.sample(frame_.to_local(wo_), u, u_lobe);
  if (!local) return std::nullopt;
  if (local->delta) return delta_to_world(*local);
  const Vec3 wi = normalize(frame_.to_world(local->wi_local));
  if (!same_side(wi)) return std::nullopt;
  return Scattered{wi, local->weight, local->pdf, local->delta, local->eta};
}

PathVertex::Scattered PathVertex::delta_to_world(const BsdfSample& local) const {
  const Vec3 wi = normalize(frame_.to_world(local.wi_local));
  return {bend_above(wi, local.transmitted ? -side_normal_ : side_normal_), local.weight, local.pdf, true,
          local.eta};
}

std::array<std::optional<PathVertex::Scattered>, 2> PathVertex::delta_branches() const {
  std::array<std::optional<Scattered>, 2> branches;
  const auto local = bsdf_.delta_branches(frame_.to_local(wo_));
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

}  // namespace tessera::core
