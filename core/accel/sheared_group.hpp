// The rays of a group prepared for triangle tests in double: ShearedRay of core/geometry/triangle.hpp by
// coordinate, to the bit the same numbers.
#pragma once

#include <array>

#include "core/accel/ray_columns.hpp"
#include "core/accel/triangle_hits.hpp"
#include "core/math/simd.hpp"

namespace tessera::core {

class ShearedGroup {
 public:
  explicit ShearedGroup(const RayColumns& rays) {
    for (std::size_t v = 0; v < RayColumns::kVectors; ++v) prepare(rays, v);
  }

  // Which coordinate is a ray's x, y or z: 0, 1 or 2.
  int axis(std::size_t ray, int xyz) const { return (z_axis(ray) + 1 + xyz) % 3; }

  ShearedRay ray(std::size_t i) const {
    ShearedRay ray;
    ray.z_axis = z_axis(i);
    ray.x_axis = axis(i, 0);
    ray.y_axis = axis(i, 1);
    ray.origin_x = origin_x_[i], ray.origin_y = origin_y_[i], ray.origin_z = origin_z_[i];
    ray.shear_x = shear_x_[i], ray.shear_y = shear_y_[i], ray.direction_z = direction_z_[i];
    return ray;
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
  void prepare(const RayColumns& rays, std::size_t v) {
    const std::size_t first = RayColumns::kLanes * v;
    const auto column = [&](const float(&values)[3][RayColumns::kSize], int axis) {
      return Float8::load(values[axis] + first);
    };
    const Float8 x = fabs(column(rays.direction, 0)), y = fabs(column(rays.direction, 1)),
                 z = fabs(column(rays.direction, 2));
    const Mask8 x_over_y = x > y, xy_over_z = select(x_over_y, x, y) > z;
    const Mask8 is_x = xy_over_z & x_over_y;
    z_is_y_ |= to_set((xy_over_z & !x_over_y).bits(), v);
    z_is_z_ |= to_set((!xy_over_z).bits(), v);
    // The axis that is `after` steps behind z in the circle x, y, z.
    const auto turned = [&](const float(&values)[3][RayColumns::kSize], int after) {
      return select(is_x, column(values, after),
                    select(xy_over_z, column(values, (1 + after) % 3), column(values, (2 + after) % 3)));
    };
    alignas(32) float origin[3][8], direction[3][8];
    for (int i = 0; i < 3; ++i) {
      turned(rays.origin, i).store(origin[i]);
      turned(rays.direction, i).store(direction[i]);
    }
    for (std::size_t half = 0; half < 8; half += 4) {
      const std::size_t at = first + half;
      const Double4 direction_z = Double4::load(direction[0] + half);
      Double4::load(origin[0] + half).store(origin_z_ + at);
      Double4::load(origin[1] + half).store(origin_x_ + at);
      Double4::load(origin[2] + half).store(origin_y_ + at);
      direction_z.store(direction_z_ + at);
      (Double4::load(direction[1] + half) / direction_z).store(shear_x_ + at);
      (Double4::load(direction[2] + half) / direction_z).store(shear_y_ + at);
    }
  }

  RaySet z_is_y_ = 0, z_is_z_ = 0;
  alignas(32) double origin_x_[RayColumns::kSize];
  alignas(32) double origin_y_[RayColumns::kSize];
  alignas(32) double origin_z_[RayColumns::kSize];
  alignas(32) double shear_x_[RayColumns::kSize];
  alignas(32) double shear_y_[RayColumns::kSize];
  alignas(32) double direction_z_[RayColumns::kSize];
};

}  // namespace tessera::core
