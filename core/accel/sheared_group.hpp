// SPDX-License-Identifier: Apache-2.0
// The rays of a group prepared for triangle tests in double: a structure of arrays of ShearedRay
// (core/geometry/triangle.hpp), bit-identical to it.
#pragma once

#include <array>

#include "core/accel/bvh_layout.hpp"
#include "core/accel/ray_columns.hpp"
#include "core/accel/triangle_hits.hpp"

namespace tessera::core::accel {

class ShearedGroup {
 public:
  template <typename AnyRay>
  explicit ShearedGroup(const RayColumns<AnyRay>& rays) {
    for (std::size_t v = 0; v < rays.vectors(); ++v) prepare(rays, v);
  }

  // The coordinate that is a ray's x, y or z: 0, 1 or 2.
  int axis(std::size_t ray, int xyz) const { return kTurned[z_axis(ray)][xyz]; }

  // Gathers rays by index, one in each lane of D (DoubleHalf or DoubleN); or loads consecutive rays from
  // `first` on, a multiple of the lanes of D.
  template <typename D>
  ShearedRaysOf<D> rays(const std::array<std::size_t, D::kLanes>& of) const {
    return with<D>([&](const double* a) { return D::of([&](std::size_t k) { return a[of[k]]; }); });
  }
  template <typename D>
  ShearedRaysOf<D> rays(std::size_t first) const {
    return with<D>([first](const double* values) { return D::load(values + first); });
  }
  // Ray i in all lanes.
  ShearedRaysOf<DoubleHalf> rays_like(std::size_t i) const {
    return with<DoubleHalf>([i](const double* values) { return DoubleHalf(values[i]); });
  }

  // The corners of triangles, one in each lane, along the axes of rays. `lanes[k]` points to the first x of
  // a lane of BvhPacket::corners.
  template <typename D>
  class Corners {
   public:
    using Lanes = std::array<const float*, D::kLanes>;

    D operator()(int corner, int xyz) const {
      return coordinates_[static_cast<std::size_t>(corner)][static_cast<std::size_t>(xyz)];
    }

   private:
    friend ShearedGroup;
    // Bit k of `z_is_y` and `z_is_z` is set if that axis is the z of ray k.
    Corners(const Lanes& lanes, unsigned z_is_y, unsigned z_is_z) {
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const auto world = [&](std::size_t axis) {
          return D::of([&](std::size_t k) { return lanes[k][(3 * corner + axis) * BvhPacket::kWidth]; });
        };
        const std::array<D, 3> xyz = {world(0), world(1), world(2)};
        const auto turned = [&](std::size_t axis) {
          const auto of = [&](std::size_t z) { return xyz[static_cast<std::size_t>(kTurned[z][axis])]; };
          return select(z_is_z, of(2), select(z_is_y, of(1), of(0)));
        };
        coordinates_[corner] = {turned(0), turned(1), turned(2)};
      }
    }

    std::array<std::array<D, 3>, 3> coordinates_;
  };
  template <typename D>
  Corners<D> corners(const typename Corners<D>::Lanes& lanes,
                     const std::array<std::size_t, D::kLanes>& of) const {
    unsigned z_is_y = 0, z_is_z = 0;
    for (std::size_t k = 0; k < D::kLanes; ++k) {
      z_is_y |= static_cast<unsigned>(z_is_y_ >> of[k] & 1) << k;
      z_is_z |= static_cast<unsigned>(z_is_z_ >> of[k] & 1) << k;
    }
    return {lanes, z_is_y, z_is_z};
  }
  template <typename D>
  Corners<D> corners(const typename Corners<D>::Lanes& lanes, std::size_t first) const {
    return {lanes, static_cast<unsigned>(z_is_y_ >> first), static_cast<unsigned>(z_is_z_ >> first)};
  }

 private:
  // The coordinates that are x, y and z if z is the first, second or third coordinate.
  static constexpr std::int8_t kTurned[3][3] = {{1, 2, 0}, {2, 0, 1}, {0, 1, 2}};

  template <typename D, typename At>
  ShearedRaysOf<D> with(const At& at) const {
    return {at(origin_x_), at(origin_y_), at(origin_z_), at(shear_x_), at(shear_y_), at(direction_z_)};
  }

  int z_axis(std::size_t ray) const {
    return static_cast<int>((z_is_z_ >> ray & 1) << 1 | (z_is_y_ >> ray & 1));
  }

  // Processes a vector at a time, with the axes that longest_axis chooses.
  template <typename AnyRay>
  void prepare(const RayColumns<AnyRay>& rays, std::size_t v) {
    using Lanes = typename RayColumns<AnyRay>::Lanes;
    const std::size_t first = RayColumns<AnyRay>::kLanes * v;
    const auto column = [first](const auto& values, int axis) { return Lanes::load(values[axis] + first); };
    const Lanes x = fabs(column(rays.direction, 0)), y = fabs(column(rays.direction, 1)),
                z = fabs(column(rays.direction, 2));
    const MaskVector x_over_y = x > y, xy_over_z = select(x_over_y, x, y) > z;
    const MaskVector is_x = xy_over_z & x_over_y;
    z_is_y_ |= to_set((xy_over_z & !x_over_y).bits(), v);
    z_is_z_ |= to_set((!xy_over_z).bits(), v);
    // The axis `after` steps behind z in the cycle x, y, z.
    const auto turned = [&](const auto& values, int after) {
      return in_double(
          select(is_x, column(values, after),
                 select(xy_over_z, column(values, (1 + after) % 3), column(values, (2 + after) % 3))));
    };
    turned(rays.origin, 0).store(origin_z_ + first);
    turned(rays.origin, 1).store(origin_x_ + first);
    turned(rays.origin, 2).store(origin_y_ + first);
    const DoubleVector direction_z = turned(rays.direction, 0);
    direction_z.store(direction_z_ + first);
    (turned(rays.direction, 1) / direction_z).store(shear_x_ + first);
    (turned(rays.direction, 2) / direction_z).store(shear_y_ + first);
  }

  RaySet z_is_y_ = 0, z_is_z_ = 0;
  alignas(kVectorAlignment) double origin_x_[kGroupSize];
  alignas(kVectorAlignment) double origin_y_[kGroupSize];
  alignas(kVectorAlignment) double origin_z_[kGroupSize];
  alignas(kVectorAlignment) double shear_x_[kGroupSize];
  alignas(kVectorAlignment) double shear_y_[kGroupSize];
  alignas(kVectorAlignment) double direction_z_[kGroupSize];
};

}  // namespace tessera::core::accel
