// Four pairs of a ray and a triangle at once: intersect_triangle of core/geometry/triangle.hpp, lane by lane
// the same operations, and so to the bit the same hits.
#pragma once

#include "core/geometry/rounding.hpp"
#include "core/geometry/triangle.hpp"
#include "core/math/simd.hpp"

namespace tessera::core {

// One ray in all lanes, or a ray each.
struct ShearedRays {
  explicit ShearedRays(const ShearedRay& ray)
      : origin_x(ray.origin_x),
        origin_y(ray.origin_y),
        origin_z(ray.origin_z),
        shear_x(ray.shear_x),
        shear_y(ray.shear_y),
        direction_z(ray.direction_z) {}
  ShearedRays(Double4 ox, Double4 oy, Double4 oz, Double4 sx, Double4 sy, Double4 dz)
      : origin_x(ox), origin_y(oy), origin_z(oz), shear_x(sx), shear_y(sy), direction_z(dz) {}

  Double4 origin_x, origin_y, origin_z, shear_x, shear_y, direction_z;
};

class TriangleHits {
 public:
  // corner(i, axis) answers with the coordinate of the i-th corners along the ray's x, y or z: 0, 1 or 2.
  template <typename Corner>
  TriangleHits(const ShearedRays& rays, const Corner& corner) {
    const ShearedCorners corners(rays, corner);
    const Edges e(corners);
    lanes_ = e.of_one_sign();
    if (lanes_ != 0) find_distances(corners, e, rays.direction_z);
  }

  // Those that may hit at or before `limit`: all that do, and those that only their error bound, or rounding
  // to float, keeps from it. No branches, and no division.
  template <typename Corner>
  static unsigned may_hit(const ShearedRays& rays, float limit, const Corner& corner) {
    const ShearedCorners corners(rays, corner);
    const Edges e(corners);
    const Fraction t = distance(corners, e, rays.direction_z);
    const Double4 zero = Double4::broadcast(0), beyond = Double4::broadcast(limit * (1 + 0x1p-20));
    const unsigned behind = less(t.numerator, zero) ^ less(t.denominator, zero);
    return e.of_one_sign() & ~behind & ~less(beyond * abs(t.denominator), abs(t.numerator));
  }

  // For pairs that are known to hit.
  struct Certain {};
  template <typename Corner>
  TriangleHits(const ShearedRays& rays, const Corner& corner, Certain) : lanes_(0xfu) {
    const ShearedCorners corners(rays, corner);
    compute(corners, Edges(corners), rays.direction_z);
  }

  // Those that hit.
  unsigned lanes() const { return lanes_; }
  float t(int lane) const { return static_cast<float>(t_[lane]); }
  float b1(int lane) const { return static_cast<float>(e1_[lane] / det_[lane]); }
  float b2(int lane) const { return static_cast<float>(e2_[lane] / det_[lane]); }
  // Of all four, where any of them hits; aligned to 16 bytes.
  void store(float* t, float* b1, float* b2) const {
    const Double4 det = Double4::load(det_);
    Double4::load(t_).store(t);
    (Double4::load(e1_) / det).store(b1);
    (Double4::load(e2_) / det).store(b2);
  }

 private:
  // The corners as ShearedRay::shear moves them.
  struct ShearedCorners {
    template <typename Corner>
    ShearedCorners(const ShearedRays& rays, const Corner& corner) {
      for (int i = 0; i < 3; ++i) {
        z[i] = corner(i, 2) - rays.origin_z;
        x[i] = corner(i, 0) - rays.origin_x - rays.shear_x * z[i];
        y[i] = corner(i, 1) - rays.origin_y - rays.shear_y * z[i];
      }
    }

    Double4 x[3], y[3], z[3];  // of each corner
  };

  // The edge functions: the areas that the ray's foot spans with each side.
  struct Edges {
    explicit Edges(const ShearedCorners& c)
        : e0(difference_of_products(c.x[1], c.y[2], c.y[1], c.x[2])),
          e1(difference_of_products(c.x[2], c.y[0], c.y[2], c.x[0])),
          e2(difference_of_products(c.x[0], c.y[1], c.y[0], c.x[1])) {}

    Double4 sum() const { return e0 + e1 + e2; }
    // The lanes where no two have different signs.
    unsigned of_one_sign() const {
      const Double4 zero = Double4::broadcast(0);
      const unsigned any_negative = less(min(min(e0, e1), e2), zero);
      const unsigned any_positive = less(zero, max(max(e0, e1), e2));
      return 0xfu & ~(any_negative & any_positive);
    }

    Double4 e0, e1, e2;
  };

  static Double4 difference_of_products(Double4 a, Double4 b, Double4 c, Double4 d) {
    const Double4 cd = c * d;
    const Double4 error_of_cd = negative_multiply_add(c, d, cd);
    return multiply_subtract(a, b, cd) + error_of_cd;
  }

  // Leaves only the lanes whose t is provably positive.
  void find_distances(const ShearedCorners& corners, const Edges& e, Double4 direction_z) {
    const auto& z = corners.z;
    const Double4 zero = Double4::broadcast(0);
    const auto [t, scale] = compute(corners, e, direction_z);
    lanes_ &= less(zero, t);  // not where det is 0
    // A corner is ahead where z has the sign of direction_z, so that their product is positive.
    const unsigned all_ahead =
        less(zero, min(min(z[0] * direction_z, z[1] * direction_z), z[2] * direction_z));
    if ((lanes_ & ~all_ahead) != 0) lanes_ &= all_ahead | less(t_error_bound(corners, e) / abs(scale), t);
  }

  struct Fraction {
    Double4 numerator, denominator;
  };
  static Fraction distance(const ShearedCorners& corners, const Edges& e, Double4 direction_z) {
    const auto& z = corners.z;
    return {e.e0 * z[0] + e.e1 * z[1] + e.e2 * z[2], e.sum() * direction_z};
  }

  struct Distance {
    Double4 t, scale;
  };
  Distance compute(const ShearedCorners& corners, const Edges& e, Double4 direction_z) {
    const Fraction fraction = distance(corners, e, direction_z);
    const Double4 t = fraction.numerator / fraction.denominator;
    t.store(t_);
    e.e1.store(e1_);
    e.e2.store(e2_);
    e.sum().store(det_);
    return {t, fraction.denominator};
  }

  static Double4 max_abs(Double4 a, Double4 b, Double4 c) { return max(max(abs(a), abs(b)), abs(c)); }

  // As the function of this name in core/geometry/triangle.cpp.
  static Double4 t_error_bound(const ShearedCorners& c, const Edges& e) {
    const Double4 max_x = max_abs(c.x[0], c.x[1], c.x[2]), max_y = max_abs(c.y[0], c.y[1], c.y[2]);
    const Double4 max_z = max_abs(c.z[0], c.z[1], c.z[2]), max_e = max_abs(e.e0, e.e1, e.e2);
    const auto times_gamma = [](int n, Double4 a) { return Double4::broadcast(gamma<double>(n)) * a; };
    const Double4 delta_x = times_gamma(5, max_x + max_z);
    const Double4 delta_y = times_gamma(5, max_y + max_z);
    const Double4 delta_z = times_gamma(3, max_z);
    const Double4 delta_e =
        Double4::broadcast(2) * (times_gamma(2, max_x) * max_y + delta_y * max_x + delta_x * max_y);
    return Double4::broadcast(3) * (times_gamma(3, max_e) * max_z + delta_e * max_z + delta_z * max_e);
  }

  unsigned lanes_;
  alignas(32) double t_[4];
  alignas(32) double e1_[4];
  alignas(32) double e2_[4];
  alignas(32) double det_[4];
};

}  // namespace tessera::core
