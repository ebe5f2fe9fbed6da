// SPDX-License-Identifier: Apache-2.0
// A vector of pairs of a ray and a triangle at once, in float: which surely miss, which surely hit and about
// where, and which are too close for float to tell. The watertight test in double
// (core/geometry/triangle.hpp) decides those, and computes the hits that matter, so that this filter changes
// no hit. It follows the same steps.
//
// The error bounds: let u be the unit roundoff of float. Coordinates relative to the origin have relative
// error u, shears (of magnitude 2 at most) 2u, so that a sheared coordinate is wrong by
// u (|X| + 3 |S Z| + |x|) <= u (2L + 8Z), where L is the largest sheared |x| or |y| of the triangle and Z the
// largest |z|. An origin (X, Y, Z) that is no float is wrong itself, by up to 2u of each coordinate, which
// adds 2u O, with O = max(|X|, |Y|) + 2 |Z|. An edge function is then wrong by E = 4 L u (2L + 8Z + 2 O) +
// 3 u L^2 = u L (11 L + 32 Z + 8 O), to first order. Where all three have one sign, weights of the corners
// are wrong by 3 E / det each way, and t by Z (6 E / det + 11 u) + u O. Each bound is taken a little larger,
// and a tiny number is added for what underflows.
#pragma once

#include "core/geometry/rounding.hpp"
#include "core/math/simd_widest.hpp"

namespace tessera::core {

// Rays as the filter takes them, a lane each or one in all lanes; x, y and z are axes of which the
// directions' z is at least half the longest. A ray whose shear is NaN is never told anything for sure.
struct FilterRays {
  FloatVector origin_x, origin_y, origin_z;
  FloatVector shear_x, shear_y;  // the direction's x and y for each unit of z
  FloatVector inverse_z;         // of the direction
  FloatVector origin_terms;      // O, 0 where origins are exact
};

class TriangleFilter {
 public:
  // corner(i, axis) answers with the coordinate of the i-th corners along x, y or z: 0, 1 or 2.
  template <typename Corner>
  TriangleFilter(const FilterRays& rays, const Corner& corner) {
    for (int i = 0; i < 3; ++i) {
      z_[i] = corner(i, 2) - rays.origin_z;
      x_[i] = negative_multiply_add(rays.shear_x, z_[i], corner(i, 0) - rays.origin_x);
      y_[i] = negative_multiply_add(rays.shear_y, z_[i], corner(i, 1) - rays.origin_y);
    }
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      e_[i] = multiply_subtract(x_[j], y_[k], y_[j] * x_[k]);
    }
    const FloatVector extent = max(max_abs(x_), max_abs(y_));
    max_z_ = max_abs(z_);
    const FloatVector of_origin_and_z =
        multiply_add(FloatVector(kErrorOfZ), max_z_, FloatVector(kErrorOfOrigin) * rays.origin_terms);
    e_error_ = multiply_add(extent, multiply_add(FloatVector(kErrorOfExtent), extent, of_origin_and_z),
                            FloatVector(0x1p-120f));
    least_ = min(min(e_[0], e_[1]), e_[2]);
    greatest_ = max(max(e_[0], e_[1]), e_[2]);
  }

  // Where edge functions are surely of both signs.
  MaskVector surely_outside() const { return (least_ < -e_error_) & (e_error_ < greatest_); }
  // Where they are surely of the same sign.
  MaskVector surely_inside() const { return (e_error_ < least_) | (greatest_ < -e_error_); }

  // Bounds on t, which mean something where the ray is surely inside.
  struct Interval {
    FloatVector low, high;
  };
  Interval t(const FilterRays& rays) const {
    const FloatVector inverse_det = FloatVector(1) / (e_[0] + e_[1] + e_[2]);
    const FloatVector z =
        e_[0] * inverse_det * z_[0] + e_[1] * inverse_det * z_[1] + e_[2] * inverse_det * z_[2];
    const FloatVector t = z * rays.inverse_z;
    const FloatVector relative_error =
        FloatVector(6.5f) * e_error_ * fabs(inverse_det) + FloatVector(gamma<float>(16));
    const FloatVector error_of_z = multiply_add(max_z_ + FloatVector(0x1p-100f), relative_error,
                                                FloatVector(gamma<float>(2)) * rays.origin_terms);
    const FloatVector error = error_of_z * fabs(rays.inverse_z);
    return {t - error, t + error};
  }

 private:
  static constexpr float kErrorOfExtent = gamma<float>(12), kErrorOfZ = gamma<float>(33),
                         kErrorOfOrigin = gamma<float>(10);

  static FloatVector max_abs(const FloatVector (&a)[3]) {
    return max_magnitude(max_magnitude(a[0], a[1]), a[2]);
  }

  FloatVector x_[3], y_[3], z_[3];  // the corners, sheared as ShearedRay::shear does
  FloatVector e_[3];                // the edge functions
  FloatVector e_error_, max_z_, least_, greatest_;
};

}  // namespace tessera::core
