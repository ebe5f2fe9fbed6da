// SPDX-License-Identifier: Apache-2.0
// A vector of ray-triangle pairs (D is DoubleHalf or DoubleN). Each lane performs the operations of
// intersect_triangle (core/geometry/triangle.hpp), so the hits are bit-identical.
#pragma once

#include "core/geometry/rounding.hpp"
#include "core/geometry/triangle.hpp"
#include "core/math/simd.hpp"

namespace tessera::core::accel {

// One ray in all lanes, or one ray in each.
template <typename D>
struct ShearedRaysOf {
  explicit ShearedRaysOf(const ShearedRay& ray)
      : origin_x(ray.origin_x),
        origin_y(ray.origin_y),
        origin_z(ray.origin_z),
        shear_x(ray.shear_x),
        shear_y(ray.shear_y),
        direction_z(ray.direction_z) {}
  ShearedRaysOf(D ox, D oy, D oz, D sx, D sy, D dz)
      : origin_x(ox), origin_y(oy), origin_z(oz), shear_x(sx), shear_y(sy), direction_z(dz) {}

  D origin_x, origin_y, origin_z, shear_x, shear_y, direction_z;
};

template <typename D>
class TriangleHitsOf {
 public:
  using ShearedRays = ShearedRaysOf<D>;

  // corner(i, axis) returns the coordinate of the i-th corners along the ray's x, y or z (0, 1 or 2).
  template <typename Corner>
  TriangleHitsOf(const ShearedRays& rays, const Corner& corner) {
    const ShearedCorners corners(rays, corner);
    const Edges e(corners);
    lanes_ = e.of_one_sign();
    if (lanes_ != 0) find_distances(corners, e, rays.direction_z);
  }

  // The pairs that may hit at or before `limit`: all hits, and those that only their error bound, or
  // rounding to float, excludes. Has no branches and no division.
  template <typename Corner>
  static unsigned may_hit(const ShearedRays& rays, float limit, const Corner& corner) {
    const ShearedCorners corners(rays, corner);
    const Edges e(corners);
    const Fraction t = distance(corners, e, rays.direction_z);
    const D zero = D(0), beyond = D(limit * (1 + 0x1p-20));
    const unsigned behind = less(t.numerator, zero) ^ less(t.denominator, zero);
    return e.of_one_sign() & ~behind & ~less(beyond * fabs(t.denominator), fabs(t.numerator));
  }

  // Tag for pairs that are known to hit.
  struct Certain {};
  template <typename Corner>
  TriangleHitsOf(const ShearedRays& rays, const Corner& corner, Certain) : lanes_(kAll) {
    const ShearedCorners corners(rays, corner);
    compute(corners, Edges(corners), rays.direction_z);
  }

  // The lanes that hit.
  unsigned lanes() const { return lanes_; }
  float t(int lane) const { return static_cast<float>(t_[lane]); }
  float b1(int lane) const { return static_cast<float>(e1_[lane] / det_[lane]); }
  float b2(int lane) const { return static_cast<float>(e2_[lane] / det_[lane]); }
  // Stores all lanes, provided that any of them hits; the arrays are aligned to the size of D.
  void store(float* t, float* b1, float* b2) const {
    const D det = D::load(det_);
    D::load(t_).store(t);
    (D::load(e1_) / det).store(b1);
    (D::load(e2_) / det).store(b2);
  }

 private:
  static constexpr std::size_t kLanes = D::kLanes;
  static constexpr unsigned kAll = (1u << kLanes) - 1;

  // The corners after ShearedRay::shear.
  struct ShearedCorners {
    template <typename Corner>
    ShearedCorners(const ShearedRays& rays, const Corner& corner) {
      for (int i = 0; i < 3; ++i) {
        z[i] = corner(i, 2) - rays.origin_z;
        x[i] = corner(i, 0) - rays.origin_x - rays.shear_x * z[i];
        y[i] = corner(i, 1) - rays.origin_y - rays.shear_y * z[i];
      }
    }

    D x[3], y[3], z[3];  // of each corner
  };

  // The edge functions: twice the signed areas that the ray's foot point spans with each side.
  struct Edges {
    explicit Edges(const ShearedCorners& c)
        : e0(difference_of_products(c.x[1], c.y[2], c.y[1], c.x[2])),
          e1(difference_of_products(c.x[2], c.y[0], c.y[2], c.x[0])),
          e2(difference_of_products(c.x[0], c.y[1], c.y[0], c.x[1])) {}

    D sum() const { return e0 + e1 + e2; }
    // The lanes in which no two edge functions have opposite signs.
    unsigned of_one_sign() const {
      const D zero = D(0);
      const unsigned any_negative = less(min(min(e0, e1), e2), zero);
      const unsigned any_positive = less(zero, max(max(e0, e1), e2));
      return kAll & ~(any_negative & any_positive);
    }

    D e0, e1, e2;
  };

  static D difference_of_products(D a, D b, D c, D d) {
    const D cd = c * d;
    const D error_of_cd = negative_multiply_add(c, d, cd);
    return multiply_subtract(a, b, cd) + error_of_cd;
  }

  // Keeps only the lanes whose t is provably positive.
  void find_distances(const ShearedCorners& corners, const Edges& e, D direction_z) {
    const auto& z = corners.z;
    const D zero = D(0);
    const auto [t, scale] = compute(corners, e, direction_z);
    lanes_ &= less(zero, t);  // rejects det = 0
    // A corner is ahead if z has the sign of direction_z, so that their product is positive.
    const unsigned all_ahead =
        less(zero, min(min(z[0] * direction_z, z[1] * direction_z), z[2] * direction_z));
    if ((lanes_ & ~all_ahead) != 0) lanes_ &= all_ahead | less(t_error_bound(corners, e) / fabs(scale), t);
  }

  struct Fraction {
    D numerator, denominator;
  };
  static Fraction distance(const ShearedCorners& corners, const Edges& e, D direction_z) {
    const auto& z = corners.z;
    return {e.e0 * z[0] + e.e1 * z[1] + e.e2 * z[2], e.sum() * direction_z};
  }

  struct Distance {
    D t, scale;
  };
  Distance compute(const ShearedCorners& corners, const Edges& e, D direction_z) {
    const Fraction fraction = distance(corners, e, direction_z);
    const D t = fraction.numerator / fraction.denominator;
    t.store(t_);
    e.e1.store(e1_);
    e.e2.store(e2_);
    e.sum().store(det_);
    return {t, fraction.denominator};
  }

  static D max_abs(D a, D b, D c) { return max(max(fabs(a), fabs(b)), fabs(c)); }

  // Equals the function of this name in core/geometry/triangle.cpp.
  static D t_error_bound(const ShearedCorners& c, const Edges& e) {
    const D max_x = max_abs(c.x[0], c.x[1], c.x[2]), max_y = max_abs(c.y[0], c.y[1], c.y[2]);
    const D max_z = max_abs(c.z[0], c.z[1], c.z[2]), max_e = max_abs(e.e0, e.e1, e.e2);
    const auto times_gamma = [](int n, D a) { return D(gamma<double>(n)) * a; };
    const D delta_x = times_gamma(5, max_x + max_z);
    const D delta_y = times_gamma(5, max_y + max_z);
    const D delta_z = times_gamma(3, max_z);
    const D delta_e = D(2) * (times_gamma(2, max_x) * max_y + delta_y * max_x + delta_x * max_y);
    return D(3) * (times_gamma(3, max_e) * max_z + delta_e * max_z + delta_z * max_e);
  }

  unsigned lanes_;
  alignas(8 * kLanes) double t_[kLanes];
  alignas(8 * kLanes) double e1_[kLanes];
  alignas(8 * kLanes) double e2_[kLanes];
  alignas(8 * kLanes) double det_[kLanes];
};

}  // namespace tessera::core::accel
