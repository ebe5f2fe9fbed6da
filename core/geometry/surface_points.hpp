// SPDX-License-Identifier: Apache-2.0
// Surface points in lanes, to set or read individually.
#pragma once

#include "core/geometry/surface.hpp"
#include "core/math/lane_array.hpp"
#include "core/math/simd_double.hpp"

namespace tessera::core {

class SurfacePoints {
 public:
  // All zero.
  SurfacePoints() : SurfacePoints(SurfacePointOf<FloatN>{}) {}
  explicit SurfacePoints(const SurfacePointOf<FloatN>& all)
      : position_(all.position),
        position_error_(all.position_error),
        geometric_normal_(all.geometric_normal),
        shading_normal_(all.shading_normal),
        u_(all.uv.x),
        v_(all.uv.y) {}

  void set(std::size_t lane, const SurfacePoint& point) {
    position_.set(lane, point.position);
    position_error_.set(lane, point.position_error);
    geometric_normal_.set(lane, point.geometric_normal);
    shading_normal_.set(lane, point.shading_normal);
    u_.set(lane, point.uv.x);
    v_.set(lane, point.uv.y);
  }
  SurfacePoint operator[](std::size_t lane) const {
    return {position_[lane],
            position_error_[lane],
            geometric_normal_[lane],
            shading_normal_[lane],
            {u_[lane], v_[lane]}};
  }
  SurfacePointOf<FloatN> all() const {
    return {position_.all(),
            position_error_.all(),
            geometric_normal_.all(),
            shading_normal_.all(),
            {u_.all(), v_.all()}};
  }

 private:
  Vec3Lanes position_, position_error_, geometric_normal_, shading_normal_;
  FloatLanes u_, v_;
};

// `a` where the mask is set, else `b`.
inline SurfacePointOf<FloatN> select(MaskN mask, const SurfacePointOf<FloatN>& a,
                                     const SurfacePointOf<FloatN>& b) {
  return {select(mask, a.position, b.position),
          select(mask, a.position_error, b.position_error),
          select(mask, a.geometric_normal, b.geometric_normal),
          select(mask, a.shading_normal, b.shading_normal),
          {select(mask, a.uv.x, b.uv.x), select(mask, a.uv.y, b.uv.y)}};
}

}  // namespace tessera::core
