// SPDX-License-Identifier: Apache-2.0
#include "core/lights/area_light.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/geometry/cylinder.hpp"
#include "core/geometry/disk.hpp"
#include "core/geometry/placement.hpp"
#include "core/geometry/sphere.hpp"
#include "core/geometry/vec3d.hpp"
#include "core/math/elementary.hpp"
#include "core/math/frame.hpp"
#include "core/math/lane_array.hpp"
#include "core/sampling/warp.hpp"
#include "core/textures/opacity.hpp"

namespace tessera::core::lights {
namespace {

// n consecutive roundings change a value by at most this factor minus one (Higham 2002, section 3.1).
constexpr float rounding_bound(int n) {
  constexpr float kHalfUlp = std::numeric_limits<float>::epsilon() / 2;
  return static_cast<float>(n) * kHalfUlp / (1 - static_cast<float>(n) * kHalfUlp);
}

// In double precision: the squares of very long and very short edges do not fit a float.
float area_of(const TriangleLight& t) {
  const Vec3d p0(t.p0);
  return static_cast<float>(length(cross(Vec3d(t.p1) - p0, Vec3d(t.p2) - p0)) / 2);
}
float area_of(const QuadLight& q) {
  return static_cast<float>(length(cross(Vec3d(q.edge_u), Vec3d(q.edge_v))));
}
float area_of(const SphereLight& s) {
  return 4 * kPi * s.radius * s.radius;
}

float area_of(const DiskLight& d) {
  return static_cast<float>(Disk{d.center, d.radius_u, d.radius_v, d.inner}.area());
}
float area_of(const CylinderLight& c) {
  return static_cast<float>(cylinder_area(Vec3d(c.axis), Vec3d(c.radius_u), Vec3d(c.radius_v)));
}

Aabb box_of(const TriangleLight& t) {
  Aabb box;
  for (const Vec3 p : {t.p0, t.p1, t.p2}) box.include(p);
  return box;
}
Aabb box_of(const QuadLight& q) {
  Aabb box;
  for (const Vec3 p : {q.corner, q.corner + q.edge_u, q.corner + q.edge_v, q.corner + q.edge_u + q.edge_v})
    box.include(p);
  return box;
}
Aabb box_of(const SphereLight& s) {
  const Vec3 reach{s.radius, s.radius, s.radius};
  return {s.center - reach, s.center + reach};
}

Aabb box_of(const DiskLight& d) {
  return Disk{d.center, d.radius_u, d.radius_v, d.inner}.bounds();
}
Aabb box_of(const CylinderLight& c) {
  return Cylinder(c.start, c.axis, c.radius_u, c.radius_v, c.flipped).bounds();
}

template <typename T>
SurfacePointOf<T> flat_point(Vec3Of<T> position, Vec3Of<T> magnitude, Vec3Of<T> normal) {
  SurfacePointOf<T> point;
  point.position = position;
  point.position_error = magnitude * T(rounding_bound(8));
  point.geometric_normal = normal;
  return point;
}

template <typename T>
SurfacePointOf<T> point_of_quad(const QuadLightOf<T>& q, Vec3Of<T> normal, Vec2Of<T> u) {
  const Vec3Of<T> position = q.corner + q.edge_u * u.x + q.edge_v * u.y;
  const Vec3Of<T> magnitude = abs(q.corner) + abs(q.edge_u * u.x) + abs(q.edge_v * u.y);
  SurfacePointOf<T> point = flat_point(position, magnitude, normal);
  point.uv = u;
  return point;
}

// Converts an area density to a solid angle density.
template <typename T>
T per_solid_angle(T area, Vec3Of<T> p_lit, Vec3Of<T> p_light, Vec3Of<T> normal) {
  using std::fabs, std::sqrt;
  const Vec3Of<T> d = p_light - p_lit;
  const T distance2 = length_squared(d);
  const T cos_light = fabs(dot(d, normal)) / sqrt(distance2);
  return select(cos_light > 0, distance2 / (cos_light * area), T(0.0f));
}

// The cone of directions that a sphere subtends from an outside point, by its squared sine and one minus
// its cosine. There is none from inside, nor from points that rounding may have put on either side of the
// sphere.
template <typename T>
struct ConeOf {
  ConeOf(const SphereOf<T>& sphere, Vec3Of<T> p_lit) {
    using std::sqrt;
    constexpr float kClearlyOutside = 1.01f;
    const T distance2 = length_squared(p_lit - sphere.center), radius2 = sphere.radius * sphere.radius;
    exists = distance2 > kClearlyOutside * radius2;
    sin2_max = radius2 / distance2;
    // sin^2 / (1 + cos) avoids cancellation for small cones.
    one_minus_cos_max = sin2_max / (1 + sqrt(larger(T(0.0f), 1 - sin2_max)));
  }

  T pdf() const { return 1 / (2 * kPi * one_minus_cos_max); }
  // The sphere's normal where a direction that is uniform in the cone meets it (Pharr et al. 2023, section
  // 6.2.4). `axis` points from the sphere's centre to the reference point.
  Vec3Of<T> sample(Vec3Of<T> axis, Vec2Of<T> u) const {
    using std::sqrt;
    const T one_minus_cos = u.x * one_minus_cos_max;
    const T cos_theta = 1 - one_minus_cos;
    const T sin2_theta = one_minus_cos * (1 + cos_theta);
    // The angle at the centre between the axis and the point that the direction meets.
    const T cos_alpha =
        sin2_theta / sqrt(sin2_max) + cos_theta * sqrt(larger(T(0.0f), 1 - sin2_theta / sin2_max));
    const T sin_alpha = sqrt(larger(T(0.0f), 1 - cos_alpha * cos_alpha));
    const auto [sin_phi, cos_phi] = sin_cos_turns(u.y);
    return FrameOf<T>::around(normalize(axis))
        .to_world({sin_alpha * cos_phi, sin_alpha * sin_phi, cos_alpha});
  }

  MaskOf<T> exists;
  T sin2_max, one_minus_cos_max;
};

// The direction from the axis of the cylinder to the point `cosine` radius_u + `sine` radius_v of its
// surface, and the area per unit of its texture coordinates there.
struct CylinderSide {
  CylinderSide(const CylinderLight& c, double cosine, double sine) {
    const Vec3d u(c.radius_u), v(c.radius_v);
    const Vec3d across = cross(cosine * v - sine * u, Vec3d(c.axis));
    const double size = length(across);
    area = static_cast<float>(2 * std::numbers::pi * size);
    outward = face_toward(((1 / size) * across).rounded(), (cosine * u + sine * v).rounded());
  }

  float area;
  Vec3 outward;  // unit
};

// The side on which `position` lies.
CylinderSide side_at(const CylinderLight& c, Vec3 position) {
  const Placement place(Transform{c.radius_u, c.radius_v, c.axis, c.start});
  const Vec3d unit = place.object_point(Vec3d(position));
  const double scale = 1 / std::sqrt(unit.x * unit.x + unit.y * unit.y);
  return {c, scale * unit.x, scale * unit.y};
}

template <typename T>
struct FoundOnSphere {
  SurfacePointOf<T> point;
  T pdf;
};

// Uniform in the cone from outside; uniform over the area otherwise, and if the far side is visible.
template <typename T>
FoundOnSphere<T> find_on_sphere(const SphereOf<T>& sphere, T deviation, T area, Vec3Of<T> p_lit, Vec2Of<T> u,
                                bool far_side_seen = false) {
  ConeOf<T> cone(sphere, p_lit);
  if (far_side_seen) cone.exists = false;
  Vec3Of<T> outward = cone.sample(p_lit - sphere.center, u);
  T pdf = cone.pdf();
  if (!all(cone.exists)) outward = select(cone.exists, outward, sampling::sample_sphere(u));
  SurfacePointOf<T> point;
  point.position = sphere.center + outward * sphere.radius;
  point.position_error = (abs(sphere.center) + abs(outward) * sphere.radius) * T(rounding_bound(8)) +
                         Vec3Of<T>{deviation, deviation, deviation};
  point.geometric_normal = outward;
  if (!all(cone.exists))
    pdf = select(cone.exists, pdf, per_solid_angle(area, p_lit, point.position, outward));
  return {point, pdf};
}

}  // namespace

AreaLight::AreaLight(LightShape shape, Vec3 front, const SurfaceEmission& emission)
    : shape_(shape),
      front_(front),
      area_(std::visit([](const auto& s) { return area_of(s); }, shape)),
      radiance_(emission.radiance),
      mean_radiance_(emission.mean_radiance),
      opacity_(emission.opacity),
      two_sided_(emission.two_sided),
      is_opaque_(emission.is_opaque()),
      batch_(batch_of(shape, emission)) {}

AreaLight::Batch AreaLight::batch_of(const LightShape& shape, const SurfaceEmission& emission) {
  if (!emission.is_opaque()) return Batch::kNone;
  if (std::holds_alternative<QuadLight>(shape)) return Batch::kQuads;
  const bool even = std::holds_alternative<SphereLight>(shape) && emission.radiance.texture < 0;
  return even ? Batch::kEvenSpheres : Batch::kNone;
}

Rgb AreaLight::emitted(const std::vector<Texture>& textures, Vec3 position, const UvSets& uv, Vec3 wo) const {
  const Vec3 front = front_at(position);
  if (!two_sided_ && !(dot(front, wo) > 0)) return {};
  if (radiance_.texture < 0) return radiance_.value;
  const Vec3 normal = std::holds_alternative<SphereLight>(shape_) ? normalize(front) : front;
  return radiance_.evaluate(textures, {uv, position, normal});
}

Vec3 AreaLight::front_at(Vec3 position) const {
  if (const auto* sphere = std::get_if<SphereLight>(&shape_)) return position - sphere->center;
  const auto* cylinder = std::get_if<CylinderLight>(&shape_);
  if (cylinder == nullptr) return front_;
  const Vec3 outward = side_at(*cylinder, position).outward;
  return cylinder->flipped ? -outward : outward;
}

std::optional<LightSample> AreaLight::sample(const std::vector<Texture>& textures, Vec3 p_lit, Vec2 u) const {
  return emitted_by(textures, find(p_lit, u));
}

std::optional<LightSample> AreaLight::sample_along(const std::vector<Texture>& textures, Vec3 p_lit,
                                                   Vec3 forward, Vec2 u) const {
  const Sample found = find(p_lit, u);
  return emitted_by(textures, dot(found.wi, forward) < 0 ? before(found, p_lit) : found);
}

AreaLight::Sample AreaLight::find(Vec3 p_lit, Vec2 u) const {
  return std::visit([&](const auto& shape) { return find(shape, p_lit, u); }, shape_);
}

// The sample for a ray that meets the light before it comes to p_lit. That is the same point, but for spheres
// that p_lit sees only one side of: the ray comes from the other side.
AreaLight::Sample AreaLight::before(const Sample& behind, Vec3 p_lit) const {
  Sample found = behind;
  found.wi = -behind.wi;
  const auto* sphere = std::get_if<SphereLight>(&shape_);
  if (sphere == nullptr || !is_opaque_ || !ConeOf<float>({sphere->center, sphere->radius}, p_lit).exists)
    return found;
  const Vec3 near_side = behind.point.geometric_normal;
  const Vec3 outward = near_side - behind.wi * (2 * dot(near_side, behind.wi));
  found.point.position = sphere->center + outward * sphere->radius;
  found.point.position_error = behind.point.position_error * 2;
  found.point.geometric_normal = outward;
  found.point.uv = uv_of(*sphere, outward);
  found.uv = found.point.uv;
  return found;
}

// Nothing if the sample is of no use.
std::optional<LightSample> AreaLight::emitted_by(const std::vector<Texture>& textures,
                                                 const Sample& found) const {
  if (!(found.pdf > 0) || !std::isfinite(found.pdf)) return std::nullopt;
  const Rgb radiance =
      emitted(textures, found.point.position, found.uv, -found.wi) *
      opacity_at(opacity_, textures, {found.uv, found.point.position, found.point.geometric_normal});
  if (is_black(radiance)) return std::nullopt;
  return LightSample{found.wi, radiance, found.pdf, false, found.point};
}

// A point sampled uniformly over the area. The density is NaN if it is the reference point itself.
AreaLight::Sample AreaLight::flat(const SurfacePoint& point, Vec3 p_lit) const {
  return {point, point.uv, normalize(point.position - p_lit),
          per_solid_angle(area_, p_lit, point.position, point.geometric_normal)};
}

AreaLight::Sample AreaLight::find(const TriangleLight& t, Vec3 p_lit, Vec2 u) const {
  const Vec2 b = sampling::sample_triangle(u);
  const float b0 = 1 - b.x - b.y;
  const Vec3 position = t.p0 * b0 + t.p1 * b.x + t.p2 * b.y;
  const Vec3 magnitude = abs(t.p0 * b0) + abs(t.p1 * b.x) + abs(t.p2 * b.y);
  SurfacePoint point = flat_point(position, magnitude, front_);
  if (!t.uvs) return flat(point, p_lit);
  const auto& [uv0, uv1, uv2] = *t.uvs;
  point.uv = uv0.first * b0 + uv1.first * b.x + uv2.first * b.y;
  Sample sample = flat(point, p_lit);
  sample.uv.second = uv0.second * b0 + uv1.second * b.x + uv2.second * b.y;
  return sample;
}

AreaLight::Sample AreaLight::find(const QuadLight& q, Vec3 p_lit, Vec2 u) const {
  return flat(point_of_quad(q, front_, u), p_lit);
}

AreaLight::Sample AreaLight::find(const DiskLight& d, Vec3 p_lit, Vec2 u) const {
  const RingPoint ring = sample_ring(d.inner, u);
  const Vec3 along_u = d.radius_u * ring.x, along_v = d.radius_v * ring.y;
  SurfacePoint point =
      flat_point(d.center + along_u + along_v, abs(d.center) + abs(along_u) + abs(along_v), front_);
  point.uv = ring.uv;
  return flat(point, p_lit);
}

// Uniform by texture coordinates: over the area if the cylinder is circular.
AreaLight::Sample AreaLight::find(const CylinderLight& c, Vec3 p_lit, Vec2 u) const {
  const auto [sine, cosine] = sin_cos_turns(u.x);
  const Vec3 along_u = c.radius_u * cosine, along_v = c.radius_v * sine, along_axis = c.axis * u.y;
  const CylinderSide side(c, double{cosine}, double{sine});
  SurfacePoint point;
  point.position = c.start + along_u + along_v + along_axis;
  // The rounding of sine and cosine, and of the radii themselves, moves points off the surface.
  point.position_error =
      (abs(c.start) + abs(c.radius_u) + abs(c.radius_v) + abs(c.axis)) * rounding_bound(16);
  point.geometric_normal = c.flipped ? -side.outward : side.outward;
  point.uv = u;
  return {point, point.uv, normalize(point.position - p_lit),
          per_solid_angle(side.area, p_lit, point.position, side.outward)};
}

LightSamples AreaLight::sample_quads(const std::array<const AreaLight*, 8>& quads,
                                     const std::vector<Texture>& textures, Vec3Of<FloatN> p_lit,
                                     Vec2Of<FloatN> u) {
  Vec3Lanes corner, edge_u, edge_v, front;
  FloatLanes area;
  std::array<const ColorParameter*, kLaneCount> radiance;
  unsigned two_sided = 0;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    const AreaLight& light = *quads[lane];
    const QuadLight& quad = *std::get_if<QuadLight>(&light.shape_);
    corner.set(lane, quad.corner);
    edge_u.set(lane, quad.edge_u);
    edge_v.set(lane, quad.edge_v);
    front.set(lane, light.front_);
    area.set(lane, light.area_);
    radiance[lane] = &light.radiance_;
    two_sided |= (light.two_sided_ ? 1u : 0u) << lane;
  }
  LightSamples samples;
  samples.point = point_of_quad<FloatN>({corner.all(), edge_u.all(), edge_v.all()}, front.all(), u);
  samples.wi = normalize(samples.point.position - p_lit);
  samples.pdf = per_solid_angle(area.all(), p_lit, samples.point.position, front.all());
  samples.radiance =
      evaluate(radiance, textures, TexturePointOf<FloatN>(u, samples.point.position, front.all()));
  const MaskN emits = MaskN::from_bits(two_sided) | (dot(front.all(), -samples.wi) > 0);
  samples.found = (samples.pdf > 0) & (samples.pdf < std::numeric_limits<float>::infinity()) & emits &
                  !is_black(samples.radiance);
  return samples;
}

AreaLight::Sample AreaLight::find(const SphereLight& sphere, Vec3 p_lit, Vec2 u) const {
  auto [point, pdf] =
      find_on_sphere<float>({sphere.center, sphere.radius}, sphere.deviation, area_, p_lit, u, !is_opaque_);
  point.uv = uv_of(sphere, point.geometric_normal);
  return {point, point.uv, normalize(point.position - p_lit), pdf};
}

// Where the light has textures.
Vec2 AreaLight::uv_of(const SphereLight& sphere, Vec3 outward) const {
  if (radiance_.texture < 0 && opacity_.texture < 0) return {};
  return sphere_uv({dot(outward, sphere.x_axis), dot(outward, sphere.y_axis), dot(outward, sphere.z_axis)});
}

LightSamples AreaLight::sample_uniform_spheres(const std::array<const AreaLight*, 8>& spheres,
                                               Vec3Of<FloatN> p_lit, Vec2Of<FloatN> u) {
  Vec3Lanes center;
  FloatLanes radius, deviation, area;
  RgbLanes radiance;
  unsigned two_sided = 0;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    const AreaLight& light = *spheres[lane];
    const SphereLight& sphere = *std::get_if<SphereLight>(&light.shape_);
    center.set(lane, sphere.center);
    radius.set(lane, sphere.radius);
    deviation.set(lane, sphere.deviation);
    area.set(lane, light.area_);
    radiance.set(lane, light.radiance_.value);
    two_sided |= (light.two_sided_ ? 1u : 0u) << lane;
  }
  LightSamples samples;
  const SphereOf<FloatN> balls{center.all(), radius.all()};
  const auto found = find_on_sphere(balls, deviation.all(), area.all(), p_lit, u);
  samples.point = found.point;
  samples.wi = normalize(found.point.position - p_lit);
  samples.pdf = found.pdf;
  samples.radiance = radiance.all();
  const MaskN emits =
      MaskN::from_bits(two_sided) | (dot(found.point.position - balls.center, -samples.wi) > 0);
  samples.found = (samples.pdf > 0) & (samples.pdf < std::numeric_limits<float>::infinity()) & emits &
                  !is_black(samples.radiance);
  return samples;
}

float AreaLight::pdf(Vec3 p_lit, Vec3 p_light) const {
  if (const auto* cylinder = std::get_if<CylinderLight>(&shape_)) {
    const CylinderSide side = side_at(*cylinder, p_light);
    return per_solid_angle(side.area, p_lit, p_light, side.outward);
  }
  const auto* sphere = std::get_if<SphereLight>(&shape_);
  if (!sphere) return per_solid_angle(area_, p_lit, p_light, front_);
  const ConeOf<float> cone({sphere->center, sphere->radius}, p_lit);
  if (cone.exists && is_opaque_) return cone.pdf();
  return per_solid_angle(area_, p_lit, p_light, normalize(p_light - sphere->center));
}

double AreaLight::power() const {
  const bool inside_unseen = std::holds_alternative<SphereLight>(shape_) && is_opaque_;
  const int sides = two_sided_ && !inside_unseen ? 2 : 1;
  return mean_radiance_ * static_cast<double>(area_) * static_cast<double>(kPi) * sides;
}

// A sphere is seen as a disk, a quarter of its area. A cylinder emits about as a sphere of its area does, on
// one side or on both.
LightBounds AreaLight::bounds() const {
  if (std::holds_alternative<CylinderLight>(shape_)) {
    const double seen_area = static_cast<double>(area_) / 4 * (two_sided_ ? 2 : 1);
    return LightBounds({box_of(*std::get_if<CylinderLight>(&shape_)), seen_area}, NormalCone::all(),
                       Falloff::cosine(), mean_radiance_ * seen_area, false);
  }
  const bool sphere = std::holds_alternative<SphereLight>(shape_);
  const double seen_area = static_cast<double>(area_) / (sphere ? 4 : 1);
  return LightBounds({std::visit([](const auto& s) { return box_of(s); }, shape_), seen_area},
                     sphere ? NormalCone::all() : NormalCone::only(front_), Falloff::cosine(),
                     mean_radiance_ * seen_area, two_sided_ && !sphere);
}

}  // namespace tessera::core::lights
