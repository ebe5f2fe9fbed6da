// SPDX-License-Identifier: Apache-2.0
// A group of rays that go into the same octant against boxes, a vector of rays or of boxes at once, and all
// rays together by bounds of their origins and directions. Of Rays, or of ObjectRays, whose origins, in
// double, are rounded so that boxes begin too early and end too late.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "core/accel/box_test.hpp"
#include "core/accel/bvh_layout.hpp"
#include "core/accel/ray_columns.hpp"
#include "core/accel/triangle_filter.hpp"

namespace tessera::core {

template <typename AnyRay>
class RayGroup {
 public:
  using Columns = RayColumns<AnyRay>;
  static constexpr std::size_t kSize = Columns::kSize, kLanes = Columns::kLanes, kVectors = Columns::kVectors;

  explicit RayGroup(const Columns& rays);

  // Which of a node's boxes a ray meets, and where.
  unsigned boxes_met_by(std::size_t ray, const BvhNode& node, float* t_near) const {
    unsigned met = 0;
    for (std::size_t lane = 0; lane < BvhNode::kWidth; lane += kLanes) {
      FloatVector near(0), far(limit_[ray]);
      for (int axis = 0; axis < 3; ++axis) {
        const FloatVector of_near(origin_[kNear][axis][ray]), of_far(origin_[kFar][axis][ray]);
        near = max((FloatVector::load(node.bounds[near_side_[axis]] + lane) - of_near) *
                       FloatVector(inverse_[axis][ray]),
                   near);
        far = min((FloatVector::load(node.bounds[far_side_[axis]] + lane) - of_far) *
                      FloatVector(far_inverse_[axis][ray]),
                  far);
      }
      near.store(t_near + lane);
      met |= less_equal(near, far) << lane;
    }
    return met;
  }

  // Where a ray enters the box in a lane of a node that it meets.
  float entry_into(const BvhNode& node, std::size_t lane, std::size_t ray) const {
    float near = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float plane = node.bounds[near_side_[axis]][lane];
      near = std::max(near, (plane - origin_[kNear][axis][ray]) * inverse_[axis][ray]);
    }
    return near;
  }

  // Boxes that begin beyond a ray's limit do not concern it.
  float limit(std::size_t ray) const { return limit_[ray]; }
  void set_limit(std::size_t ray, float limit) { limit_[ray] = limit; }
  // The rays of a vector hit something at t, or anything may be hit before t.
  void set_limits(std::size_t vector, FloatVector t) {
    min(t * FloatVector(kBoxSlack), FloatVector(std::numeric_limits<float>::max()))
        .store(limit_ + kLanes * vector);
  }
  // Those of `set` whose limit is not below t.
  RaySet reaching(RaySet set, float t) const;

  // Which of a node's boxes some ray of the group may meet: all that any ray meets, and perhaps others.
  // Writes a lower bound of the distances to each box.
  unsigned boxes_met(const BvhNode& node, float* t_near) const;
  // meeting[lane] becomes the rays of `set` that meet the box in that lane of a node. Box by box, for the
  // lanes of `met`:
  void rays_meeting(const BvhNode& node, unsigned met, RaySet set,
                    std::array<RaySet, BvhNode::kWidth>& meeting) const;
  // Ray by ray, for all lanes; answers with those where there are any.
  unsigned rays_meeting(const BvhNode& node, RaySet set, std::array<RaySet, BvhNode::kWidth>& meeting) const;

  // The rays of one vector as the filter of triangles takes them, with axes x, y and z.
  FilterRays filter_rays(std::size_t vector) const {
    const auto at = [&](const float* values) { return FloatVector::load(values + kLanes * vector); };
    return {at(origin_[kNear][filter_axes_[0]]),
            at(origin_[kNear][filter_axes_[1]]),
            at(origin_[kNear][filter_axes_[2]]),
            at(shear_[0]),
            at(shear_[1]),
            at(inverse_[filter_axes_[2]]),
            FloatVector(origin_terms_)};
  }
  const int* filter_axes() const { return filter_axes_; }
  // Whether the filter can tell something about every ray.
  bool can_filter() const { return can_filter_; }

 private:
  RaySet rays_meeting_box(const BvhNode& node, int lane, RaySet set) const;
  using Lanes = typename Columns::Lanes;
  // Of origins, those that boxes' near and far sides are taken relative to. Rays' own are exact.
  static constexpr int kOrigins = std::is_same_v<AnyRay, Ray> ? 1 : 2, kNear = 0, kFar = kOrigins - 1;

  // Sets and bounds origins and inverses of one axis; `negative` says where the rays go.
  void set_axis(const Columns& rays, int axis, bool negative);
  void set_bounds(int axis, bool negative);
  void store_origins(Lanes origin, int axis, std::size_t first, bool negative);
  void prepare_filter(const Columns& rays);
  void choose_filter_axes(const Columns& rays);
  Lanes filter_inverse(const Columns& rays, std::size_t first) const;

  int near_side_[3], far_side_[3];  // of BvhNode::bounds
  // Bounds over all rays, those of origins ordered as a ray meets them: boxes' near sides are taken relative
  // to the first, far sides to the second.
  float origin_bounds_[3][2], inverse_bounds_[3][2], far_inverse_bounds_[3][2];
  bool has_bounds_;
  bool can_filter_;
  int filter_axes_[3];
  float origin_terms_ = 0;  // of FilterRays, the largest
  std::size_t count_;       // of rays, in whole vectors
  alignas(kVectorAlignment) float origin_[kOrigins][3][kSize];
  alignas(kVectorAlignment) float inverse_[3][kSize];
  alignas(kVectorAlignment) float far_inverse_[3][kSize];
  alignas(kVectorAlignment) float limit_[kSize];
  alignas(kVectorAlignment) float shear_[2][kSize];
};

}  // namespace tessera::core
