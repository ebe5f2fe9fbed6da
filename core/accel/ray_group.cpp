#include "core/accel/ray_group.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/accel/box_test.hpp"
#include "core/geometry/triangle.hpp"

namespace tessera::core {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

float least(Float8 a) {
  alignas(32) float lanes[8];
  a.store(lanes);
  return *std::min_element(lanes, lanes + 8);
}
float greatest(Float8 a) {
  return -least(-a);
}

}  // namespace

RayGroup::RayGroup(const RayColumns& rays) {
  has_bounds_ = true;
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < kSize; i += kLanes) {
      const Float8 inverse = Float8(1) / Float8::load(rays.direction[axis] + i);
      Float8::load(rays.origin[axis] + i).store(origin_[axis] + i);
      inverse.store(inverse_[axis] + i);
      (inverse * Float8(kBoxSlack)).store(far_inverse_[axis] + i);
    }
    set_bounds(axis, std::signbit(rays.direction[axis][0]));
  }
  for (std::size_t v = 0; v < kVectors; ++v)
    set_limits(v, min(Float8::load(rays.t_max + kLanes * v), Float8(kInfinity)));
  prepare_filter(rays);
}

// A NaN stays outside the bounds: a ray that has one hits nothing.
void RayGroup::set_bounds(int axis, bool negative) {
  near_side_[axis] = 3 * (negative ? BvhNode::kUpper : BvhNode::kLower) + axis;
  far_side_[axis] = 3 * (negative ? BvhNode::kLower : BvhNode::kUpper) + axis;
  Float8 least_origin(kInfinity), greatest_origin(-kInfinity);
  Float8 least_inverse(kInfinity), greatest_inverse(-kInfinity);
  for (std::size_t i = 0; i < kSize; i += kLanes) {
    const Float8 origin = Float8::load(origin_[axis] + i), inverse = Float8::load(inverse_[axis] + i);
    least_origin = min(origin, least_origin);
    greatest_origin = max(origin, greatest_origin);
    least_inverse = min(inverse, least_inverse);
    greatest_inverse = max(inverse, greatest_inverse);
  }
  const float low = least(least_origin), high = greatest(greatest_origin);
  origin_bounds_[axis][0] = negative ? low : high;
  origin_bounds_[axis][1] = negative ? high : low;
  inverse_bounds_[axis][0] = least(least_inverse);
  inverse_bounds_[axis][1] = greatest(greatest_inverse);
  for (int i = 0; i < 2; ++i) {
    far_inverse_bounds_[axis][i] = inverse_bounds_[axis][i] * kBoxSlack;
    has_bounds_ =
        has_bounds_ && std::isfinite(origin_bounds_[axis][i]) && std::isfinite(far_inverse_bounds_[axis][i]);
  }
}

// z is the axis along which most of the rays are long.
void RayGroup::prepare_filter(const RayColumns& rays) {
  Float8 sum[3] = {0.0f, 0.0f, 0.0f};
  for (int axis = 0; axis < 3; ++axis)
    for (std::size_t i = 0; i < kSize; i += kLanes)
      sum[axis] = sum[axis] + fabs(Float8::load(rays.direction[axis] + i));
  const int z = longest_axis(Vec3{greatest(sum[0]), greatest(sum[1]), greatest(sum[2])});
  const int x = (z + 1) % 3, y = (z + 2) % 3;
  filter_axes_[0] = x, filter_axes_[1] = y, filter_axes_[2] = z;
  Mask8 all_in_range(true);
  for (std::size_t i = 0; i < kSize; i += kLanes) {
    const Float8 inverse = Float8::load(inverse_[z] + i);
    const Float8 shear_x = Float8::load(rays.direction[x] + i) * inverse;
    const Float8 shear_y = Float8::load(rays.direction[y] + i) * inverse;
    const Mask8 in_range = (fabs(inverse) > Float8(0x1p-100f)) & (fabs(inverse) < Float8(0x1p100f)) &
                           (fabs(shear_x) <= Float8(2)) & (fabs(shear_y) <= Float8(2));
    shear_x.store(shear_[0] + i);
    shear_y.store(shear_[1] + i);
    all_in_range = all_in_range & in_range;
  }
  can_filter_ = all(all_in_range);
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

void RayGroup::rays_meeting(const BvhNode& node, unsigned met, RaySet set,
                            std::array<RaySet, BvhNode::kWidth>& meeting) const {
  for (; met != 0; met &= met - 1) {
    const int lane = std::countr_zero(met);
    meeting[static_cast<std::size_t>(lane)] = rays_meeting_box(node, lane, set);
  }
}

RaySet RayGroup::rays_meeting_box(const BvhNode& node, int lane, RaySet set) const {
  RaySet meeting = 0;
  Float8 planes_near[3], planes_far[3];
  for (int axis = 0; axis < 3; ++axis) {
    planes_near[axis] = Float8(node.bounds[near_side_[axis]][lane]);
    planes_far[axis] = Float8(node.bounds[far_side_[axis]][lane]);
  }
  for (std::size_t v = 0; v < kVectors; ++v) {
    if (lanes_of(set, v) == 0) continue;
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

// A row of sixteen bits for each ray becomes a column of 64 for each box.
unsigned RayGroup::rays_meeting(const BvhNode& node, RaySet set,
                                std::array<RaySet, BvhNode::kWidth>& meeting) const {
  alignas(32) std::uint8_t rows[2][kSize] = {};
  unsigned met_by_any = 0;
  for_each_ray(set, [&](std::size_t i) {
    const unsigned met = boxes_met_by(i, node);
    rows[0][i] = static_cast<std::uint8_t>(met);
    rows[1][i] = static_cast<std::uint8_t>(met >> 8);
    met_by_any |= met;
  });
  transpose_bits(rows[0], meeting.data());
  transpose_bits(rows[1], meeting.data() + 8);
  return met_by_any;
}

}  // namespace tessera::core
