// SPDX-License-Identifier: Apache-2.0
#include "core/lights/moving_area_light.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include "core/base/overloaded.hpp"
#include "core/geometry/object_point.hpp"

namespace tessera::core::lights {
namespace {

constexpr float kTimes[] = {0, 0.5f, 1};

}  // namespace

MovingAreaLight::MovingAreaLight(const LightShape& shape, Vec3 front, const SurfaceEmission& emission,
                                 std::shared_ptr<const MovingPlacement> motion)
    : parts_(std::make_shared<const Parts>(Parts{shape, front, emission, std::move(motion)})) {}

AreaLight MovingAreaLight::at(float time) const {
  const auto& [shape, front, emission, motion] = *parts_;
  const Placement placement = motion->at(time);
  return {placed(shape, placement), unit_or_zero(placement.normal(Vec3d(front))), emission};
}

double MovingAreaLight::power() const {
  double greatest = 0;
  for (const float time : kTimes) greatest = std::max(greatest, at(time).power());
  return greatest;
}

LightBounds MovingAreaLight::bounds() const {
  const auto& [shape, front, emission, motion] = *parts_;
  const Aabb box = motion->bounds({AreaLight(shape, front, emission).bounds().box()});
  double area = 0, watts = 0;
  for (const float time : kTimes) {
    const LightBounds still = at(time).bounds();
    area = std::max(area, still.area());
    watts = std::max(watts, still.power());
  }
  const LightBounds unit({box, area}, NormalCone::all(), Falloff::cosine(), 1, false);
  return LightBounds({box, area}, NormalCone::all(), Falloff::cosine(), watts / unit.power(), false);
}

LightShape placed(const LightShape& shape, const Placement& placement) {
  const auto point = [&](Vec3 p) { return placement.point(Vec3d(p)).rounded(); };
  const auto vector = [&](Vec3 v) { return placement.vector(Vec3d(v)).rounded(); };
  return std::visit(
      Overloaded{[&](const TriangleLight& t) -> LightShape {
                   return TriangleLight{point(t.p0), point(t.p1), point(t.p2), t.uvs};
                 },
                 [&](const QuadLight& q) -> LightShape {
                   return QuadLight{point(q.corner), vector(q.edge_u), vector(q.edge_v)};
                 },
                 [&](const SphereLight& s) -> LightShape {
                   const Vec3 x = vector({1, 0, 0}), y = vector({0, 1, 0}), z = vector({0, 0, 1});
                   const float radius = s.radius * length(x);
                   return SphereLight{point(s.center), radius,       4 * kRoundToRounding * radius,
                                      normalize(x),    normalize(y), normalize(z)};
                 },
                 [&](const DiskLight& d) -> LightShape {
                   return DiskLight{point(d.center), vector(d.radius_u), vector(d.radius_v), d.inner};
                 },
                 [&](const CylinderLight& c) -> LightShape {
                   return CylinderLight{point(c.start), vector(c.axis), vector(c.radius_u),
                                        vector(c.radius_v), c.flipped};
                 }},
      shape);
}

}  // namespace tessera::core::lights
