// SPDX-License-Identifier: Apache-2.0
// A conservative ray-triangle test in float for a vector of pairs: which surely miss, which surely hit with
// bounds on t, and which are undecided. The watertight test in double (core/geometry/triangle.hpp) decides
// the latter and computes the hits that matter, so this filter changes no hit. It follows the same steps.
//
// Error bounds: let u be the unit roundoff of float. Coordinates relative to the origin have relative error
// u, and shears (of magnitude 2 at most) 2u. The error of a sheared coordinate is thus at most u (|X| + 3
// |S Z| + |x|) <= u (2L + 8Z), where L is the largest sheared |x| or |y| of the triangle and Z the largest
// |z|. An origin (X, Y, Z) rounded from double has an error of up to 2u of each coordinate, which adds 2u
// O, with O = max(|X|, |Y|) + 2 |Z|. The error of an edge function is then at most E = 4 L u (2L + 8Z + 2
// O) + 3 u L^2 = u L (11 L + 32 Z + 8 O), to first order. If all three have one sign, barycentric
// coordinates have errors of at most 3 E / det, and t of Z (6 E / det + 11 u) + u O. Each bound is rounded
// up a little, and a tiny number is added for underflow.
#pragma once

#include "core/geometry/rounding.hpp"
#include "core/math/simd_widest.hpp"

namespace tessera::core::accel {

// Rays in the form that the filter takes, one in each lane or one in all lanes. The z component of a
// direction is at least half its largest component. A ray whose shear is NaN is never decided.
struct FilterRays {
  FloatVector origin_x, origin_y, origin_z;
  FloatVector shear_x, shear_y;  // the direction's x and y per unit of z
  FloatVector inverse_z;         // 1 / direction z
  FloatVector origin_terms;      // O; 0 if origins are exact
};

class TriangleFilter {
 public:
  // corner(i, axis) returns the coordinate of the i-th corners along x, y or z (0, 1 or 2).
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

  // Lanes whose edge functions surely differ in sign.
  MaskVector surely_outside() const { return (least_ < -e_error_) & (e_error_ < greatest_); }
  // Lanes whose edge functions surely have the same sign.
  MaskVector surely_inside() const { return (e_error_ < least_) | (greatest_ < -e_error_); }

  // Bounds on t, meaningful only where the ray is surely inside.
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

  FloatVector x_[3], y_[3], z_[3];  // the corners, sheared as by ShearedRay::shear
  FloatVector e_[3];                // the edge functions
  FloatVector e_error_, max_z_, least_, greatest_;
};

}  // namespace tessera::core::accel
