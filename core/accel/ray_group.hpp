// SPDX-License-Identifier: Apache-2.0
// Tests a group of rays that point into one octant against boxes: a vector of rays or of boxes at once, or
// all rays together by bounds of their origins and directions. AnyRay is Ray or ObjectRay.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "core/accel/bvh_layout.hpp"
#include "core/accel/ray_columns.hpp"
#include "core/accel/slab_test.hpp"
#include "core/accel/triangle_filter.hpp"

namespace tessera::core::accel {

template <typename AnyRay>
class RayGroup {
 public:
  using Columns = RayColumns<AnyRay>;
  static constexpr std::size_t kSize = Columns::kSize, kLanes = Columns::kLanes, kVectors = Columns::kVectors;

  explicit RayGroup(const Columns& rays);

  // The mask of a node's boxes that a ray meets, and their entry distances.
  unsigned boxes_met_by(std::size_t ray, const BvhNode& node, float* t_near) const {
    return core::accel::boxes_met(OneRay{*this, ray}, sides_, FloatVector(limit_[ray]), node, t_near);
  }

  // The distance at which a ray enters the box in a lane that it meets. In vectors, whose maximum is never
  // compiled to a branch.
  float entry_into(const BvhNode& node, std::size_t lane, std::size_t ray) const {
    FloatN near(0.0f);
    for (int axis = 0; axis < 3; ++axis) {
      const FloatN plane(node.bounds[sides_.near[axis]][lane]), origin(origin_[kNear][axis][ray]);
      near = max((plane - origin) * FloatN(inverse_[axis][ray]), near);
    }
    return near.first();
  }

  // Boxes that begin beyond a ray's limit are skipped.
  float limit(std::size_t ray) const { return limit_[ray]; }
  void set_limit(std::size_t ray, float limit) { limit_[ray] = limit; }
  // The rays of a vector have hit something at t, or may hit anything before t.
  void set_limits(std::size_t vector, FloatVector t) {
    min(t * FloatVector(kBoxSlack), FloatVector(std::numeric_limits<float>::max()))
        .store(limit_ + kLanes * vector);
  }
  // The rays of `set` whose limit is at least t.
  RaySet reaching(RaySet set, float t) const;

  // A conservative mask of the node's boxes that any ray of the group meets. Writes a lower bound of the
  // distance to each box.
  unsigned boxes_met(const BvhNode& node, float* t_near) const;
  // meeting[lane] becomes the rays of `set` that meet the box in that lane, tested box by box for the lanes
  // of `met`.
  void rays_meeting(const BvhNode& node, unsigned met, RaySet set,
                    std::array<RaySet, BvhNode::kWidth>& meeting) const;
  // The same, tested ray by ray for all lanes; returns the lanes that any ray meets.
  unsigned rays_meeting(const BvhNode& node, RaySet set, std::array<RaySet, BvhNode::kWidth>& meeting) const;

  // The rays of one vector in the form that the triangle filter takes, with axes x, y and z.
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
  // Whether the filter can decide anything for every ray.
  bool can_filter() const { return can_filter_; }

 private:
  using Lanes = typename Columns::Lanes;
  using Origins = SlabOrigins<AnyRay>;
  static constexpr std::size_t kNear = Origins::kNear, kFar = Origins::kFar;

  // For inside_slabs: one ray in every lane.
  struct OneRay {
    FloatVector enter(int axis, FloatVector plane) const {
      return (plane - FloatVector(group.origin_[kNear][axis][ray])) * FloatVector(group.inverse_[axis][ray]);
    }
    FloatVector leave(int axis, FloatVector plane) const {
      return (plane - FloatVector(group.origin_[kFar][axis][ray])) *
             FloatVector(group.far_inverse_[axis][ray]);
    }

    const RayGroup& group;
    std::size_t ray;
  };
  // The rays of a vector.
  struct RayVector {
    static FloatVector at(const float* values, std::size_t first) {
      return FloatVector::load(values + first);
    }
    FloatVector enter(int axis, FloatVector plane) const {
      return (plane - at(group.origin_[kNear][axis], first)) * at(group.inverse_[axis], first);
    }
    FloatVector leave(int axis, FloatVector plane) const {
      return (plane - at(group.origin_[kFar][axis], first)) * at(group.far_inverse_[axis], first);
    }

    const RayGroup& group;
    std::size_t first;
  };
  // Bounds of all rays, in every lane. Rounding is monotonic, so these never enter later nor leave earlier
  // than any single ray.
  struct AllRays {
    FloatVector enter(int axis, FloatVector plane) const {
      const FloatVector to = plane - FloatVector(group.origin_bounds_[axis][0]);
      return min(to * FloatVector(group.inverse_bounds_[axis][0]),
                 to * FloatVector(group.inverse_bounds_[axis][1]));
    }
    FloatVector leave(int axis, FloatVector plane) const {
      const FloatVector to = plane - FloatVector(group.origin_bounds_[axis][1]);
      return max(to * FloatVector(group.far_inverse_bounds_[axis][0]),
                 to * FloatVector(group.far_inverse_bounds_[axis][1]));
    }

    const RayGroup& group;
  };

  RaySet rays_meeting_box(const BvhNode& node, std::size_t lane, RaySet set) const;

  // Sets and bounds the origins and inverse directions of one axis; `negative` is the sign of the
  // directions.
  void set_axis(const Columns& rays, int axis, bool negative);
  void set_bounds(int axis, bool negative);
  void prepare_filter(const Columns& rays);
  void choose_filter_axes(const Columns& rays);
  Lanes filter_inverse(const Columns& rays, std::size_t first) const;

  SlabSides sides_;
  // Bounds over all rays. Those of origins are ordered along the rays: near sides of boxes are taken
  // relative to the first, far sides relative to the second.
  float origin_bounds_[3][2], inverse_bounds_[3][2], far_inverse_bounds_[3][2];
  bool has_bounds_;
  bool can_filter_;
  int filter_axes_[3];
  float origin_terms_ = 0;  // the largest FilterRays::origin_terms
  std::size_t count_;       // rounded up to whole vectors
  alignas(kVectorAlignment) float origin_[Origins::kCount][3][kSize];
  alignas(kVectorAlignment) float inverse_[3][kSize];
  alignas(kVectorAlignment) float far_inverse_[3][kSize];
  alignas(kVectorAlignment) float limit_[kSize];
  alignas(kVectorAlignment) float shear_[2][kSize];
};

}  // namespace tessera::core::accel
