#include "core/lights/light.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/math/elementary.hpp"
#include "core/math/frame.hpp"
#include "core/sampling/warp.hpp"

namespace tessera::core {
namespace {

// n roundings in a row change a value by at most this factor less one (Higham 2002, section 3.1).
constexpr float rounding_bound(int n) {
  constexpr float kHalfUlp = std::numeric_limits<float>::epsilon() / 2;
  return static_cast<float>(n) * kHalfUlp / (1 - static_cast<float>(n) * kHalfUlp);
}

float area_of(const TriangleLight& t) {
  return length(cross(t.p1 - t.p0, t.p2 - t.p0)) / 2;
}
float area_of(const QuadLight& q) {
  return length(cross(q.edge_u, q.edge_v));
}
float area_of(const SphereLight& s) {
  return 4 * kPi * s.radius * s.radius;
}

SurfacePoint flat_point(Vec3 position, Vec3 magnitude, Vec3 normal) {
  SurfacePoint point;
  point.position = position;
  point.position_error = magnitude * rounding_bound(8);
  point.geometric_normal = normal;
  return point;
}

SurfacePoint sphere_point(const SphereLight& sphere, Vec3 outward) {
  SurfacePoint point;
  point.position = sphere.center + outward * sphere.radius;
  point.position_error = (abs(sphere.center) + abs(outward) * sphere.radius) * rounding_bound(8);
  point.geometric_normal = outward;
  return point;
}

// From outside, the cone of directions that a sphere fills, by its sine squared and one minus its cosine.
// Nothing from inside, where it fills all of them, and for points that rounding may have put on either side
// of the sphere itself.
struct Cone {
  float sin2_max;
  float one_minus_cos_max;
};

std::optional<Cone> cone_of(const SphereLight& sphere, Vec3 p_lit) {
  const float distance2 = length_squared(p_lit - sphere.center);
  const float radius2 = sphere.radius * sphere.radius;
  constexpr float kClearlyOutside = 1.01f;
  if (distance2 <= kClearlyOutside * radius2) return std::nullopt;
  const float sin2_max = radius2 / distance2;
  const float cos_max = std::sqrt(std::max(0.0f, 1 - sin2_max));
  // sin^2 / (1 + cos), which does not cancel for small cones.
  return Cone{sin2_max, sin2_max / (1 + cos_max)};
}

float pdf_cone(const Cone& cone) {
  return 1 / (2 * kPi * cone.one_minus_cos_max);
}

// Area density to solid angle density.
float per_solid_angle(float area, Vec3 p_lit, Vec3 p_light, Vec3 normal) {
  const Vec3 d = p_light - p_lit;
  const float distance2 = length_squared(d);
  const float cos_light = std::fabs(dot(d, normal)) / std::sqrt(distance2);
  return cos_light > 0 ? distance2 / (cos_light * area) : 0;
}

}  // namespace

Light::Light(LightShape shape, Vec3 front, Rgb radiance, bool two_sided)
    : shape_(shape),
      front_(front),
      area_(std::visit([](const auto& s) { return area_of(s); }, shape)),
      radiance_(radiance),
      two_sided_(two_sided) {}

Rgb Light::emitted(Vec3 p_light, Vec3 wo) const {
  if (two_sided_) return radiance_;
  const auto* sphere = std::get_if<SphereLight>(&shape_);
  const Vec3 outward = sphere ? p_light - sphere->center : front_;
  return dot(outward, wo) > 0 ? radiance_ : Rgb{};
}

std::optional<LightSample> Light::sample(Vec3 p_lit, Vec2 u) const {
  return std::visit([&](const auto& shape) { return sample(shape, p_lit, u); }, shape_);
}

std::optional<LightSample> Light::sample_flat(const SurfacePoint& point, float area, Vec3 p_lit) const {
  const Vec3 d = point.position - p_lit;
  if (length_squared(d) == 0) return std::nullopt;
  const Vec3 wi = normalize(d);
  const float pdf = per_solid_angle(area, p_lit, point.position, point.geometric_normal);
  const Rgb radiance = emitted(point.position, -wi);
  if (!(pdf > 0) || !std::isfinite(pdf) || is_black(radiance)) return std::nullopt;
  return LightSample{point, wi, pdf, radiance};
}

std::optional<LightSample> Light::sample(const TriangleLight& t, Vec3 p_lit, Vec2 u) const {
  const Vec2 b = sample_triangle(u);
  const float b0 = 1 - b.x - b.y;
  const Vec3 position = t.p0 * b0 + t.p1 * b.x + t.p2 * b.y;
  const Vec3 magnitude = abs(t.p0 * b0) + abs(t.p1 * b.x) + abs(t.p2 * b.y);
  return sample_flat(flat_point(position, magnitude, front_), area_, p_lit);
}

std::optional<LightSample> Light::sample(const QuadLight& q, Vec3 p_lit, Vec2 u) const {
  const Vec3 position = q.corner + q.edge_u * u.x + q.edge_v * u.y;
  const Vec3 magnitude = abs(q.corner) + abs(q.edge_u * u.x) + abs(q.edge_v * u.y);
  return sample_flat(flat_point(position, magnitude, front_), area_, p_lit);
}

// From outside, uniform in the cone (Pharr et al. 2023, section 6.2.4); elsewhere, uniform over the area.
std::optional<LightSample> Light::sample(const SphereLight& sphere, Vec3 p_lit, Vec2 u) const {
  const auto cone = cone_of(sphere, p_lit);
  if (!cone) return sample_flat(sphere_point(sphere, sample_sphere(u)), area_, p_lit);

  const float one_minus_cos = u.x * cone->one_minus_cos_max;
  const float cos_theta = 1 - one_minus_cos;
  const float sin2_theta = one_minus_cos * (1 + cos_theta);
  // The angle at the centre between the axis and the point that the direction meets.
  const float cos_alpha = sin2_theta / std::sqrt(cone->sin2_max) +
                          cos_theta * std::sqrt(std::max(0.0f, 1 - sin2_theta / cone->sin2_max));
  const float sin_alpha = std::sqrt(std::max(0.0f, 1 - cos_alpha * cos_alpha));
  const float phi = 2 * kPi * u.y;
  const Frame axis = Frame::around(normalize(p_lit - sphere.center));
  const Vec3 outward = axis.to_world({sin_alpha * cos(phi), sin_alpha * sin(phi), cos_alpha});

  const SurfacePoint point = sphere_point(sphere, outward);
  const Vec3 wi = normalize(point.position - p_lit);
  const Rgb radiance = emitted(point.position, -wi);
  if (is_black(radiance)) return std::nullopt;
  return LightSample{point, wi, pdf_cone(*cone), radiance};
}

float Light::pdf(Vec3 p_lit, Vec3 p_light) const {
  const auto* sphere = std::get_if<SphereLight>(&shape_);
  if (!sphere) return per_solid_angle(area_, p_lit, p_light, front_);
  if (const auto cone = cone_of(*sphere, p_lit)) return pdf_cone(*cone);
  return per_solid_angle(area_, p_lit, p_light, normalize(p_light - sphere->center));
}

double Light::power() const {
  return static_cast<double>(luminance(radiance_)) * static_cast<double>(area_) * static_cast<double>(kPi) *
         (two_sided_ && !std::holds_alternative<SphereLight>(shape_) ? 2 : 1);
}

}  // namespace tessera::core
