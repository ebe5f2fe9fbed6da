// SPDX-License-Identifier: Apache-2.0
// The ray-box test that all traversals share. Distances to slabs are computed with four roundings (Ize
// 2013), and the distance of a hit, otherwise exact to nearly double precision, is rounded once. Scaling the
// far distance by a factor guarantees that no box that contains a hit is missed.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "core/accel/bvh_layout.hpp"
#include "core/geometry/object_ray.hpp"
#include "core/geometry/ray.hpp"
#include "core/geometry/rounding.hpp"
#include "core/math/simd_widest.hpp"

namespace tessera::core::accel {

inline constexpr float kBoxSlack = 1 + 2 * gamma<float>(6);

// Boxes that begin beyond this distance hold no hit before t. The limit is finite, so that boxes beside a
// ray parallel to their sides, which begin at infinity, are rejected.
inline float box_limit(float t) {
  return std::min(t * kBoxSlack, std::numeric_limits<float>::max());
}

// The rows of BvhNode::bounds that hold the sides where rays of one octant enter and leave boxes.
struct SlabSides {
  void set(int axis, bool descends) {
    const int near_side = descends ? BvhNode::kUpper : BvhNode::kLower;
    near[axis] = 3 * near_side + axis;
    far[axis] = 3 * (1 - near_side) + axis;
  }

  std::int64_t near[3], far[3];
};

// The origins relative to which near and far sides are taken, as floats: one for a Ray, whose origin is
// exact. That of an ObjectRay, in double, is rounded so that boxes begin earlier and end later.
template <typename AnyRay>
struct SlabOrigins {
  static constexpr std::size_t kCount = std::is_same_v<AnyRay, Ray> ? 1 : 2, kNear = 0, kFar = kCount - 1;

  // Calls store(kNear or kFar, origin) with the versions of an origin, or of a vector of them.
  template <typename Real, typename Store>
  static void round(Real origin, bool descends, const Store& store) {
    if constexpr (kCount == 1) {
      store(kNear, origin);
    } else {
      const auto below = rounded_down(origin), above = -rounded_down(-origin);
      store(kNear, descends ? below : above);
      store(kFar, descends ? above : below);
    }
  }
};

// The part of a ray that is inside a box's slabs, for the ray or the box in each lane.
struct SlabInterval {
  unsigned met() const { return less_equal(near, far); }

  FloatVector near, far;
};

// `rays` says where they pass planes, by enter(axis, plane) and leave(axis, plane), and `boxes` where their
// near(axis) and far(axis) planes are.
template <typename Rays, typename Boxes>
inline SlabInterval inside_slabs(const Rays& rays, FloatVector limit, const Boxes& boxes) {
  // 0 * infinity is NaN if a ray lies in the plane of a box's side. max and min then return their second
  // argument, which ignores that side.
  SlabInterval inside{FloatVector(0), limit};
  for (int axis = 0; axis < 3; ++axis) {
    inside.near = max(rays.enter(axis, boxes.near(axis)), inside.near);
    inside.far = min(rays.leave(axis, boxes.far(axis)), inside.far);
  }
  return inside;
}

// The mask of a node's boxes that `rays`, the same in each lane, enter before `limit`, and where they do.
template <typename Rays>
inline unsigned boxes_met(const Rays& rays, const SlabSides& sides, FloatVector limit, const BvhNode& node,
                          float* t_near) {
  struct Boxes {
    FloatVector near(int axis) const { return FloatVector::load(node.bounds[sides.near[axis]] + lane); }
    FloatVector far(int axis) const { return FloatVector::load(node.bounds[sides.far[axis]] + lane); }

    const BvhNode& node;
    const SlabSides& sides;
    std::size_t lane;
  };
  unsigned met = 0;
  for (std::size_t lane = 0; lane < BvhNode::kWidth; lane += kVectorLanes) {
    const SlabInterval inside = inside_slabs(rays, limit, Boxes{node, sides, lane});
    inside.near.store(t_near + lane);
    met |= inside.met() << lane;
  }
  return met;
}

// A single ray, Ray or ObjectRay.
template <typename AnyRay>
class SlabRay {
 public:
  explicit SlabRay(const AnyRay& ray) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto inverse = static_cast<float>(1 / ray.direction[axis]);
      inverse_[axis] = FloatVector(inverse);
      far_inverse_[axis] = FloatVector(inverse * kBoxSlack);
      sides_.set(axis, std::signbit(inverse));
      Origins::round(ray.origin[axis], std::signbit(inverse), [&](std::size_t version, float origin) {
        origin_[version][axis] = FloatVector(origin);
      });
    }
  }

  unsigned boxes_met(const BvhNode& node, float limit, float* t_near) const {
    return core::accel::boxes_met(*this, sides_, FloatVector(limit), node, t_near);
  }

  FloatVector enter(int axis, FloatVector plane) const {
    return (plane - origin_[Origins::kNear][axis]) * inverse_[axis];
  }
  FloatVector leave(int axis, FloatVector plane) const {
    return (plane - origin_[Origins::kFar][axis]) * far_inverse_[axis];
  }

 private:
  using Origins = SlabOrigins<AnyRay>;

  SlabSides sides_;
  FloatVector origin_[Origins::kCount][3], inverse_[3], far_inverse_[3];
};

}  // namespace tessera::core::accel
