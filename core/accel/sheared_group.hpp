// The rays of a group prepared for triangle tests in double: ShearedRay of core/geometry/triangle.hpp by
// coordinate, to the bit the same numbers.
#pragma once

#include <array>

#include "core/accel/ray_columns.hpp"
#include "core/accel/triangle_hits.hpp"
#include "core/math/simd_double8.hpp"

namespace tessera::core {

class ShearedGroup {
 public:
  template <typename AnyRay>
  explicit ShearedGroup(const RayColumns<AnyRay>& rays) {
    for (std::size_t v = 0; v < rays.vectors(); ++v) prepare(rays, v);
  }

  // Which coordinate is a ray's x, y or z: 0, 1 or 2.
  int axis(std::size_t ray, int xyz) const {
    static constexpr std::int8_t kTurned[3][3] = {{1, 2, 0}, {2, 0, 1}, {0, 1, 2}};
    return kTurned[z_axis(ray)][xyz];
  }

  // In a lane each.
  ShearedRays rays(const std::array<std::size_t, 4>& of) const {
    const auto at = [&](const double* a) { return Double4::of(a[of[0]], a[of[1]], a[of[2]], a[of[3]]); };
    return with(at);
  }
  // Four from `first` on, which is a multiple of four.
  ShearedRays rays(std::size_t first) const {
    return with([first](const double* values) { return Double4::load(values + first); });
  }
  // One in all lanes.
  ShearedRays rays_like(std::size_t i) const {
    return with([i](const double* values) { return Double4(values[i]); });
  }

 private:
  template <typename At>
  ShearedRays with(const At& at) const {
    return {at(origin_x_), at(origin_y_), at(origin_z_), at(shear_x_), at(shear_y_), at(direction_z_)};
  }

  int z_axis(std::size_t ray) const {
    return static_cast<int>((z_is_z_ >> ray & 1) << 1 | (z_is_y_ >> ray & 1));
  }

  // Eight at a time; the axes as longest_axis chooses them.
  template <typename AnyRay>
  void prepare(const RayColumns<AnyRay>& rays, std::size_t v) {
    using Lanes = typename RayColumns<AnyRay>::Lanes;
    const std::size_t first = RayColumns<AnyRay>::kLanes * v;
    const auto column = [first](const auto& values, int axis) { return Lanes::load(values[axis] + first); };
    const Lanes x = fabs(column(rays.direction, 0)), y = fabs(column(rays.direction, 1)),
                z = fabs(column(rays.direction, 2));
    const Mask8 x_over_y = x > y, xy_over_z = select(x_over_y, x, y) > z;
    const Mask8 is_x = xy_over_z & x_over_y;
    z_is_y_ |= to_set((xy_over_z & !x_over_y).bits(), v);
    z_is_z_ |= to_set((!xy_over_z).bits(), v);
    // The axis that is `after` steps behind z in the circle x, y, z.
    const auto turned = [&](const auto& values, int after) {
      return in_double(
          select(is_x, column(values, after),
                 select(xy_over_z, column(values, (1 + after) % 3), column(values, (2 + after) % 3))));
    };
    turned(rays.origin, 0).store(origin_z_ + first);
    turned(rays.origin, 1).store(origin_x_ + first);
    turned(rays.origin, 2).store(origin_y_ + first);
    const Double8 direction_z = turned(rays.direction, 0);
    direction_z.store(direction_z_ + first);
    (turned(rays.direction, 1) / direction_z).store(shear_x_ + first);
    (turned(rays.direction, 2) / direction_z).store(shear_y_ + first);
  }

  RaySet z_is_y_ = 0, z_is_z_ = 0;
  alignas(32) double origin_x_[kGroupSize];
  alignas(32) double origin_y_[kGroupSize];
  alignas(32) double origin_z_[kGroupSize];
  alignas(32) double shear_x_[kGroupSize];
  alignas(32) double shear_y_[kGroupSize];
  alignas(32) double direction_z_[kGroupSize];
};

}  // namespace tessera::core
