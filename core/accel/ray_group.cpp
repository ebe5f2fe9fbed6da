#include "core/accel/ray_group.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/accel/box_test.hpp"
#include "core/geometry/triangle.hpp"

namespace tessera::core {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Range {
  float low = kInfinity, high = -kInfinity;
  void include(const float* values, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      low = std::min(low, values[i]);
      high = std::max(high, values[i]);
    }
  }
};

}  // namespace

RayGroup::RayGroup(std::span<const Ray> rays, std::span<const std::uint32_t> order) {
  const std::size_t count = order.size();
  all_ = count == kSize ? ~RaySet{0} : (RaySet{1} << count) - 1;
  const unsigned signs = octant(rays[order[0]]);
  alignas(32) float direction[3][kSize];
  for (std::size_t i = 0; i < kSize; ++i) {
    const Ray& ray = rays[order[std::min(i, count - 1)]];
    origin_[0][i] = ray.origin.x, origin_[1][i] = ray.origin.y, origin_[2][i] = ray.origin.z;
    direction[0][i] = ray.direction.x, direction[1][i] = ray.direction.y, direction[2][i] = ray.direction.z;
    limit_[i] = i < count ? box_limit(std::min(kInfinity, ray.t_max)) : -1;
  }
  has_bounds_ = true;
  can_filter_ = true;
  float largest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t v = 0; v < kSize; v += kLanes) {
      const Float8 inverse = Float8(1) / Float8::load(direction[axis] + v);
      inverse.store(inverse_[axis] + v);
      (inverse * Float8(kBoxSlack)).store(far_inverse_[axis] + v);
    }
    const bool negative = (signs >> axis & 1) != 0;
    near_side_[axis] = 3 * (negative ? BvhNode::kUpper : BvhNode::kLower) + axis;
    far_side_[axis] = 3 * (negative ? BvhNode::kLower : BvhNode::kUpper) + axis;
    Float8 olo(kInfinity), ohi(-kInfinity), ilo(kInfinity), ihi(-kInfinity);
    for (std::size_t v = 0; v < kSize; v += kLanes) {
      const Float8 o = Float8::load(origin_[axis] + v), i = Float8::load(inverse_[axis] + v);
      olo = min(o, olo), ohi = max(o, ohi), ilo = min(i, ilo), ihi = max(i, ihi);
    }
    alignas(32) float b[4][8];
    olo.store(b[0]), ohi.store(b[1]), ilo.store(b[2]), ihi.store(b[3]);
    Range o, i;
    o.include(b[0], 8), o.include(b[1], 8), i.include(b[2], 8), i.include(b[3], 8);
    origin_bounds_[axis][0] = negative ? o.low : o.high;
    origin_bounds_[axis][1] = negative ? o.high : o.low;
    inverse_bounds_[axis][0] = i.low, inverse_bounds_[axis][1] = i.high;
    far_inverse_bounds_[axis][0] = i.low * kBoxSlack, far_inverse_bounds_[axis][1] = i.high * kBoxSlack;
    has_bounds_ = has_bounds_ && std::isfinite(o.low) && std::isfinite(o.high) &&
                  std::isfinite(far_inverse_bounds_[axis][0]) && std::isfinite(far_inverse_bounds_[axis][1]);
    float sum = 0;
    for (std::size_t k = 0; k < kSize; k += 8) sum += std::fabs(direction[axis][k]);
    if (sum > largest || axis == 0) largest = sum, filter_axes_[2] = axis;
  }
  const int z = filter_axes_[2], x = filter_axes_[0] = (z + 1) % 3, y = filter_axes_[1] = (z + 2) % 3;
  Mask8 good(true);
  for (std::size_t v = 0; v < kSize; v += kLanes) {
    const Float8 inverse = Float8::load(inverse_[z] + v), dx = Float8::load(direction[x] + v),
                 dy = Float8::load(direction[y] + v);
    const Float8 sx = dx * inverse, sy = dy * inverse;
    const Mask8 ok = (fabs(inverse) > 0x1p-100f) & (fabs(inverse) < 0x1p100f) & (fabs(sx) <= Float8(2)) &
                     (fabs(sy) <= Float8(2));
    const Float8 nan(std::numeric_limits<float>::quiet_NaN());
    select(ok, sx, nan).store(shear_[0] + v);
    select(ok, sy, nan).store(shear_[1] + v);
    good = good & ok;
  }
  can_filter_ = core::all(good);
}

RaySet RayGroup::reaching(RaySet set, float t) const {
  RaySet reaching = 0;
  for (std::size_t v = 0; v < kVectors; ++v) {
    reaching |= RaySet{(Float8::load(limit_ + kLanes * v) >= Float8(t)).bits()} << (kLanes * v);
  }
  return set & reaching;
}

unsigned RayGroup::boxes_met(const BvhNode& node, float* t_near) const {
  if (!has_bounds_) {
    std::fill_n(t_near, BvhNode::kWidth, 0.0f);
    return 0xffffu;
  }
  // Rounding is monotonic: what the bounds give is never further than what any ray's own numbers give.
  unsigned met = 0;
  for (int lane = 0; lane < BvhNode::kWidth; lane += 8) {
    Float8 near(0), far(std::numeric_limits<float>::max());
    for (int axis = 0; axis < 3; ++axis) {
      const Float8 to_near =
          Float8::load(node.bounds[near_side_[axis]] + lane) - Float8(origin_bounds_[axis][0]);
      const Float8 to_far =
          Float8::load(node.bounds[far_side_[axis]] + lane) - Float8(origin_bounds_[axis][1]);
      near = max(min(to_near * Float8(inverse_bounds_[axis][0]), to_near * Float8(inverse_bounds_[axis][1])),
                 near);
      far = min(
          max(to_far * Float8(far_inverse_bounds_[axis][0]), to_far * Float8(far_inverse_bounds_[axis][1])),
          far);
    }
    near.store(t_near + lane);
    met |= less_equal(near, far) << lane;
  }
  return met;
}

RaySet RayGroup::rays_meeting(const BvhNode& node, int lane, RaySet set) const {
  RaySet meeting = 0;
  Float8 planes_near[3], planes_far[3];
  for (int axis = 0; axis < 3; ++axis) {
    planes_near[axis] = Float8(node.bounds[near_side_[axis]][lane]);
    planes_far[axis] = Float8(node.bounds[far_side_[axis]][lane]);
  }
  for (std::size_t v = 0; v < kVectors; ++v) {
    if (lanes(set, v) == 0) continue;
    Float8 near(0), far = Float8::load(limit_ + kLanes * v);
    for (int axis = 0; axis < 3; ++axis) {
      const Float8 origin = Float8::load(origin_[axis] + kLanes * v);
      near = max((planes_near[axis] - origin) * Float8::load(inverse_[axis] + kLanes * v), near);
      far = min((planes_far[axis] - origin) * Float8::load(far_inverse_[axis] + kLanes * v), far);
    }
    meeting |= RaySet{less_equal(near, far)} << (kLanes * v);
  }
  return meeting & set;
}

unsigned RayGroup::boxes_met_by(std::size_t ray, const BvhNode& node) const {
  unsigned met = 0;
  for (int lane = 0; lane < BvhNode::kWidth; lane += 8) {
    Float8 near(0), far(limit_[ray]);
    for (int axis = 0; axis < 3; ++axis) {
      const Float8 origin(origin_[axis][ray]);
      near = max((Float8::load(node.bounds[near_side_[axis]] + lane) - origin) * Float8(inverse_[axis][ray]),
                 near);
      far =
          min((Float8::load(node.bounds[far_side_[axis]] + lane) - origin) * Float8(far_inverse_[axis][ray]),
              far);
    }
    met |= less_equal(near, far) << lane;
  }
  return met;
}

}  // namespace tessera::core
