// SPDX-License-Identifier: Apache-2.0
#include "core/accel/ray_group.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/geometry/rounding.hpp"
#include "core/geometry/triangle.hpp"

namespace tessera::core::accel {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

float greatest(FloatVector a) {
  return -least(-a);
}

struct Bounds {
  float least, greatest;
};
// Bounds of `count` values, whole vectors. NaN values are ignored: rays that have one hit nothing.
Bounds bounds_of(const float* values, std::size_t count) {
  FloatVector low(kInfinity), high(-kInfinity);
  for (std::size_t i = 0; i < count; i += kVectorLanes) {
    low = min(FloatVector::load(values + i), low);
    high = max(FloatVector::load(values + i), high);
  }
  return {least(low), greatest(high)};
}

}  // namespace

template <typename AnyRay>
RayGroup<AnyRay>::RayGroup(const Columns& rays) : has_bounds_(true), count_(kLanes * rays.vectors()) {
  for (int axis = 0; axis < 3; ++axis) set_axis(rays, axis, std::signbit(rays.direction[axis][0]));
  std::fill_n(limit_, kSize, 0.0f);
  for (std::size_t v = 0; v < rays.vectors(); ++v)
    set_limits(v, min(FloatVector::load(rays.t_max + kLanes * v), FloatVector(kInfinity)));
  prepare_filter(rays);
}

template <typename AnyRay>
void RayGroup<AnyRay>::set_axis(const Columns& rays, int axis, bool negative) {
  sides_.set(axis, negative);
  for (std::size_t i = 0; i < count_; i += kLanes) {
    Origins::round(
        Lanes::load(rays.origin[axis] + i), negative,
        [&](std::size_t version, FloatVector origin) { origin.store(origin_[version][axis] + i); });
    const FloatVector inverse = in_float(Lanes(1.0f) / Lanes::load(rays.direction[axis] + i));
    inverse.store(inverse_[axis] + i);
    (inverse * FloatVector(kBoxSlack)).store(far_inverse_[axis] + i);
  }
  set_bounds(axis, negative);
}

template <typename AnyRay>
void RayGroup<AnyRay>::set_bounds(int axis, bool negative) {
  const Bounds of_near = bounds_of(origin_[kNear][axis], count_);
  const Bounds of_far = Origins::kCount == 1 ? of_near : bounds_of(origin_[kFar][axis], count_);
  origin_bounds_[axis][0] = negative ? of_near.least : of_near.greatest;
  origin_bounds_[axis][1] = negative ? of_far.greatest : of_far.least;
  const Bounds of_inverse = bounds_of(inverse_[axis], count_);
  inverse_bounds_[axis][0] = of_inverse.least;
  inverse_bounds_[axis][1] = of_inverse.greatest;
  for (int i = 0; i < 2; ++i) {
    far_inverse_bounds_[axis][i] = inverse_bounds_[axis][i] * kBoxSlack;
    has_bounds_ =
        has_bounds_ && std::isfinite(origin_bounds_[axis][i]) && std::isfinite(far_inverse_bounds_[axis][i]);
  }
}

// z is the axis along which most directions are longest.
template <typename AnyRay>
void RayGroup<AnyRay>::choose_filter_axes(const Columns& rays) {
  FloatVector sum[3] = {0.0f, 0.0f, 0.0f};
  for (int axis = 0; axis < 3; ++axis)
    for (std::size_t i = 0; i < count_; i += kLanes)
      sum[axis] = sum[axis] + fabs(in_float(Lanes::load(rays.direction[axis] + i)));
  const int z = longest_axis(Vec3{greatest(sum[0]), greatest(sum[1]), greatest(sum[2])});
  filter_axes_[0] = (z + 1) % 3, filter_axes_[1] = (z + 2) % 3, filter_axes_[2] = z;
}

// Shears are wrong by at most two roundings for both ray types: doubles are rounded once at the end.
template <>
FloatVector RayGroup<Ray>::filter_inverse(const Columns&, std::size_t first) const {
  return FloatVector::load(inverse_[filter_axes_[2]] + first);
}
template <>
DoubleVector RayGroup<ObjectRay>::filter_inverse(const Columns& rays, std::size_t first) const {
  return DoubleVector(1) / DoubleVector::load(rays.direction[filter_axes_[2]] + first);
}

template <typename AnyRay>
void RayGroup<AnyRay>::prepare_filter(const Columns& rays) {
  choose_filter_axes(rays);
  const auto [x, y, z] = filter_axes_;
  MaskVector all_in_range(true);
  FloatVector origin_terms(0);
  for (std::size_t i = 0; i < count_; i += kLanes) {
    const Lanes exact_inverse = filter_inverse(rays, i);
    const FloatVector inverse = in_float(exact_inverse);
    const FloatVector shear_x = in_float(Lanes::load(rays.direction[x] + i) * exact_inverse);
    const FloatVector shear_y = in_float(Lanes::load(rays.direction[y] + i) * exact_inverse);
    const MaskVector in_range = (fabs(inverse) > FloatVector(0x1p-100f)) &
                                (fabs(inverse) < FloatVector(0x1p100f)) & (fabs(shear_x) <= FloatVector(2)) &
                                (fabs(shear_y) <= FloatVector(2));
    shear_x.store(shear_[0] + i);
    shear_y.store(shear_[1] + i);
    all_in_range = all_in_range & in_range;
    const auto magnitude = [&](int axis) { return fabs(FloatVector::load(origin_[kNear][axis] + i)); };
    origin_terms = max(max(magnitude(x), magnitude(y)) + FloatVector(2) * magnitude(z), origin_terms);
  }
  can_filter_ = all(all_in_range);
  if (Origins::kCount == 2) origin_terms_ = greatest(origin_terms);
}

template <typename AnyRay>
RaySet RayGroup<AnyRay>::reaching(RaySet set, float t) const {
  RaySet reaching = 0;
  for (std::size_t v = 0; v < kVectors; ++v) {
    reaching |= RaySet{(FloatVector::load(limit_ + kLanes * v) >= FloatVector(t)).bits()} << (kLanes * v);
  }
  return set & reaching;
}

template <typename AnyRay>
unsigned RayGroup<AnyRay>::boxes_met(const BvhNode& node, float* t_near) const {
  if (!has_bounds_) {
    std::fill_n(t_near, BvhNode::kWidth, 0.0f);
    return 0xffffu;
  }
  return core::accel::boxes_met(AllRays{*this}, sides_, FloatVector(std::numeric_limits<float>::max()), node,
                                t_near);
}

template <typename AnyRay>
void RayGroup<AnyRay>::rays_meeting(const BvhNode& node, unsigned met, RaySet set,
                                    std::array<RaySet, BvhNode::kWidth>& meeting) const {
  for_each_lane(met, [&](std::size_t lane) { meeting[lane] = rays_meeting_box(node, lane, set); });
}

template <typename AnyRay>
RaySet RayGroup<AnyRay>::rays_meeting_box(const BvhNode& node, std::size_t lane, RaySet set) const {
  struct Box {
    Box(const BvhNode& node, const SlabSides& sides, std::size_t lane) {
      for (int axis = 0; axis < 3; ++axis) {
        nears[axis] = FloatVector(node.bounds[sides.near[axis]][lane]);
        fars[axis] = FloatVector(node.bounds[sides.far[axis]][lane]);
      }
    }
    FloatVector near(int axis) const { return nears[axis]; }
    FloatVector far(int axis) const { return fars[axis]; }

    FloatVector nears[3], fars[3];
  };
  const Box box(node, sides_, lane);
  RaySet meeting = 0;
  for (std::size_t v = 0; v < kVectors; ++v) {
    if (lanes_of(set, v) == 0) continue;
    const std::size_t first = kLanes * v;
    const SlabInterval inside = inside_slabs(RayVector{*this, first}, FloatVector::load(limit_ + first), box);
    meeting |= to_set(inside.met(), v);
  }
  return meeting & set;
}

// Transposes rows of sixteen bits for each ray into columns of 64 bits for each box.
template <typename AnyRay>
unsigned RayGroup<AnyRay>::rays_meeting(const BvhNode& node, RaySet set,
                                        std::array<RaySet, BvhNode::kWidth>& meeting) const {
  alignas(32) std::uint8_t rows[2][kSize] = {};
  unsigned met_by_any = 0;
  alignas(kVectorAlignment) float t_near[BvhNode::kWidth];  // unused
  for_each_ray(set, [&](std::size_t i) {
    const unsigned met = boxes_met_by(i, node, t_near);
    rows[0][i] = static_cast<std::uint8_t>(met);
    rows[1][i] = static_cast<std::uint8_t>(met >> 8);
    met_by_any |= met;
  });
  transpose_bits(rows[0], meeting.data());
  transpose_bits(rows[1], meeting.data() + 8);
  return met_by_any;
}

template class RayGroup<Ray>;
template class RayGroup<ObjectRay>;

}  // namespace tessera::core::accel
