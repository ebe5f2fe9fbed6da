// SPDX-License-Identifier: Apache-2.0
// A path vertex: the surface that a ray hit and its scattering, in world space. Lives on the stack of the
// thread that traces the path.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/geometry/primitives.hpp"
#include "core/integrators/shading_normal.hpp"
#include "core/lights/light_sample.hpp"
#include "core/math/frame.hpp"
#include "core/scene/scene.hpp"
#include "core/shading/bsdf.hpp"

namespace tessera::core::integrators {

// The side of a surface that faces the viewer, who looks along -wo.
template <typename T>
struct ViewedSide {
  ViewedSide(const SurfacePointOf<T>& surface, Vec3Of<T> wo)
      : outside(dot(surface.geometric_normal, wo) >= 0),
        normal(select(outside, surface.geometric_normal, -surface.geometric_normal)) {}

  // `outward`, the outward shading normal, flipped to this side and clamped to a valid shading normal.
  Vec3Of<T> shading_normal(Vec3Of<T> outward, Vec3Of<T> wo) const {
    return clamp_toward_viewer(clamp_above_surface(select(outside, outward, -outward), normal), wo);
  }

  MaskOf<T> outside;
  Vec3Of<T> normal;  // geometric
};

// The part of a vertex common to all materials. T is float or FloatN.
template <typename T, typename BsdfType>
class VertexOf {
 public:
  // `plain` shading normals are those of ShadingNormals::kPlain.
  VertexOf(const SurfacePointOf<T>& surface, Vec3Of<T> wo, Vec3Of<T> side_normal, Vec3Of<T> shading_normal,
           MaskOf<T> plain, const BsdfType& bsdf)
      : surface_(surface),
        wo_(wo),
        side_normal_(side_normal),
        frame_(FrameOf<T>::around(shading_normal)),
        wo_local_(frame_.to_local(wo)),
        side_local_(frame_.to_local(side_normal)),
        plain_(plain),
        bsdf_(bsdf) {
    bsdf_.scale_diffuse(select(plain_, T(1.0f), diffuse_scale(side_local_)));
    if constexpr (requires { bsdf_.look_from(wo_local_.z); }) bsdf_.look_from(wo_local_.z);
  }

  // Gives the coat, in some lanes, a frame of its own: around `normal`, which must be valid as a shading
  // normal, and turned to `tangent` unless that is zero; both in world space. To be called last.
  void turn_coat(MaskOf<T> lanes, Vec3Of<T> normal, Vec3Of<T> tangent) {
    const FrameOf<T> coat = FrameOf<T>::around(normal).turned_to(tangent);
    bsdf_.turn_coat(
        lanes, {frame_.to_local(coat.tangent), frame_.to_local(coat.bitangent), frame_.to_local(coat.normal)},
        wo_local_);
  }

  Vec3Of<T> position() const { return surface_.position; }
  const SurfacePointOf<T>& surface() const { return surface_; }
  // The geometric and the shading normal, on the side of wo.
  Vec3Of<T> side_normal() const { return side_normal_; }
  Vec3Of<T> shading_normal() const { return frame_.normal; }
  // Unit, towards the origin of the ray.
  Vec3Of<T> wo() const { return wo_; }

  // BSDF times cosine for light from `wi`, a unit direction away from the surface on either side; and the
  // density per solid angle with which sample() generates `wi`.
  BsdfValueOf<T> evaluate(Vec3Of<T> wi) const {
    const Vec3Of<T> wi_local = frame_.to_local(wi);
    return evaluate_folded(wi_local, dot(wi_local, side_local_));
  }

  RayOf<T> ray_along(Vec3Of<T> wi) const { return {offset_origin(surface_, wi), wi}; }
  // The open segment between this point and a point of another surface, for shadow rays.
  RayOf<T> ray_to(const SurfacePointOf<T>& other) const {
    const Vec3Of<T> origin = offset_origin(surface_, other.position - surface_.position);
    const Vec3Of<T> target = offset_origin(other, surface_.position - other.position);
    return {origin, target - origin, T(1.0f)};
  }

 protected:
  // The BSDF of the shading normal, folded at the geometric surface: directions scattered to the wrong side
  // of the surface are reflected to the right one, which conserves energy. Plain ones are not folded: they
  // lose that light. cos_side is the cosine of wi_local and side_local_.
  BsdfValueOf<T> evaluate_folded(Vec3Of<T> wi_local, T cos_side) const {
    const T diffuse_cos = select(plain_, wi_local.z, groove_cos(wi_local.z, cos_side, side_local_));
    BsdfValueOf<T> all = only(wi_local.z * cos_side > 0, bsdf_.evaluate(wo_local_, wi_local, diffuse_cos));
    const Vec3Of<T> image = mirrored(wi_local, side_local_, cos_side);
    const MaskOf<T> conserving = !plain_, folds = conserving & (image.z * cos_side > 0);
    if (!any(folds)) return all;
    const BsdfValueOf<T> folded = only(folds, bsdf_.evaluate(wo_local_, image, T(0.0f)));
    return {all.value + folded.value, all.pdf + folded.pdf};
  }

  // A direction sampled from the folded BSDF.
  struct FoldedSample {
    Vec3Of<T> wi_local;
    MaskOf<T> lost;            // of a plain shading normal, to the wrong side
    MaskOf<T> reweighed;       // lanes where `scattered` replaces the BSDF's value and density
    BsdfValueOf<T> scattered;  // unspecified in other lanes
  };
  FoldedSample fold(Vec3Of<T> sampled) const {
    const T cos_sampled = dot(sampled, side_local_);
    const Vec3Of<T> image = mirrored(sampled, side_local_, cos_sampled);
    const MaskOf<T> conserving = !plain_, wrong_side = sampled.z * cos_sampled <= 0;
    const MaskOf<T> lost = plain_ & wrong_side, strays = conserving & wrong_side;
    const MaskOf<T> reweighed = strays | (conserving & (image.z * cos_sampled > 0));
    if (!any(reweighed)) return {sampled, lost, reweighed, {}};
    const Vec3Of<T> wi_local = select(strays, image, sampled);
    return {wi_local, lost, reweighed, evaluate_folded(wi_local, select(strays, -cos_sampled, cos_sampled))};
  }

  SurfacePointOf<T> surface_;
  Vec3Of<T> wo_;
  Vec3Of<T> side_normal_;  // geometric, on the side of wo
  FrameOf<T> frame_;       // around the shading normal, on the side of wo
  Vec3Of<T> wo_local_;
  Vec3Of<T> side_local_;  // side_normal_ in the frame
  MaskOf<T> plain_;
  BsdfType bsdf_;

 private:
  static BsdfValueOf<T> only(MaskOf<T> mask, const BsdfValueOf<T>& value) {
    return {select(mask, value.value, RgbOf<T>{}), select(mask, value.pdf, T(0.0f))};
  }
};

// A vertex of any material.
class PathVertex : public VertexOf<float, shading::Bsdf> {
 public:
  // `boundary`, unless it is null, scatters in place of the material at the hit. Without `light` nothing
  // is dispersed.
  PathVertex(const Scene& scene, const Ray& ray, const Hit& hit, const Material* boundary = nullptr,
             std::optional<Wavelength> light = std::nullopt);

  bool is_delta() const { return bsdf_.is_delta(); }
  bool has_delta() const { return bsdf_.has_delta(); }
  // The reference point for light sampling.
  lights::LightSampleContext light_context() const {
    return {position(), bsdf_.transmits() ? Vec3{} : frame_.normal};
  }

  struct Scattered {
    Vec3 wi;
    Rgb weight;  // BSDF * cosine / pdf
    float pdf;
    bool delta;
    float eta;  // 1, or the relative index of refraction of the crossed boundary
  };
  // Returns nothing if the path ends.
  std::optional<Scattered> sample(Vec2 u, float u_lobe) const;

  // As DeltaBranches.
  std::array<std::optional<Scattered>, std::tuple_size_v<DeltaBranches>> delta_branches() const;

  // The wavelength of the path that goes on in the direction `wi` (PathState::wavelength_nm).
  float wavelength_along(Vec3 wi) const {
    return light_ ? wavelength_beyond(*light_, disperses_ && dot(wi, side_normal_) < 0) : 0;
  }

  // That of the ray that hit the surface.
  float time() const { return time_; }
  // As VertexOf::ray_along(), at the time of the ray that hit the surface.
  Ray ray_along(Vec3 wi) const { return timed(VertexOf::ray_along(wi)); }
  // A shadow ray towards the light sample.
  Ray ray_toward(const lights::LightSample& light) const;

 private:
  struct Scatterer {
    const Material* material;
    const std::optional<Wavelength>& light;
  };
  // A material of null is that at the hit.
  PathVertex(const Scene& scene, const Scatterer& scatterer, const Hit& hit, const SurfacePoint& surface,
             Vec3 wo);
  PathVertex(const Scene& scene, const Scatterer& scatterer, const Hit& hit, const SurfacePoint& surface,
             Vec3 wo, const ViewedSide<float>& side);

  Scattered delta_to_world(const BsdfSample& local) const;
  Ray timed(Ray ray) const {
    ray.time = time_;
    return ray;
  }

  float time_ = 0;
  std::optional<Wavelength> light_;
  bool disperses_;
};

// The texture coordinates of `surface`, where the hit is.
inline UvSets uv_sets_at(const Scene& scene, const Hit& hit, const SurfacePoint& surface) {
  return scene.primitives().uv_sets(hit, surface.uv);
}

// Where the textures of `surface` are looked up.
inline TexturePoint texture_point_at(const Scene& scene, const Hit& hit, const SurfacePoint& surface) {
  return {uv_sets_at(scene, hit, surface), surface.position, surface.geometric_normal};
}

// The unit directions on the surface in which u and v of the image `map` grow at a hit; zero if undefined.
Tangents image_tangents(const Scene& scene, const Texture& map, const Hit& hit, const SurfacePoint& surface);

// The cosine of the angle between a direction, unit, and the interpolated shading normal, in [0, 1].
inline float meeting_cosine(const SurfacePoint& surface, Vec3 direction) {
  return std::min(1.0f, std::fabs(dot(surface.shading_normal, direction)));
}

// Whether the direction, away from the surface, is on the side that the geometric normal points away from.
inline bool is_behind(const SurfacePoint& surface, Vec3 direction) {
  return dot(surface.geometric_normal, direction) < 0;
}

// The material that scatters light at the hit: of a blend, one of its parts, chosen by a hash of the point
// and the direction to the viewer.
const Material& scatterer_of(const Scene& scene, const Hit& hit, const SurfacePoint& surface, Vec3 wo);

// The direction on the surface along which highlights are stretched, in world space; zero if the surface has
// no texture coordinates.
Vec3 highlight_tangent(const Scene& scene, const TangentDirection& direction, const Hit& hit,
                       const SurfacePoint& surface);

// The outward shading normal: interpolated, then perturbed by the map, which must have a texture.
Vec3 mapped_normal(const Scene& scene, const NormalMap& map, const Hit& hit, const SurfacePoint& surface);

// `normal` tilted by the material's bump map, which it must have.
Vec3 bumped_normal(const Scene& scene, const Material& material, const Hit& hit, const SurfacePoint& surface,
                   Vec3 normal);

// The outward shading normal: interpolated, then perturbed by the material's maps.
Vec3 outward_normal(const Scene& scene, const Material& material, const Hit& hit,
                    const SurfacePoint& surface);

}  // namespace tessera::core::integrators
