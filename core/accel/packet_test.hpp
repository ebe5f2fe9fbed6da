// A ray against a packet's triangles, all at once: intersect_triangle of core/geometry/triangle.hpp, lane by
// lane the same operations, and so to the bit the same hits.
#pragma once

#include "core/accel/bvh_layout.hpp"
#include "core/accel/simd.hpp"
#include "core/geometry/rounding.hpp"
#include "core/geometry/triangle.hpp"

namespace tessera::core {

// A ShearedRay ready for packets.
struct PacketRay {
  explicit PacketRay(const Ray& ray) : PacketRay(ShearedRay(ray)) {}
  explicit PacketRay(const ShearedRay& ray)
      : x_axis(ray.x_axis),
        y_axis(ray.y_axis),
        z_axis(ray.z_axis),
        origin_x(Double4::broadcast(ray.origin_x)),
        origin_y(Double4::broadcast(ray.origin_y)),
        origin_z(Double4::broadcast(ray.origin_z)),
        shear_x(Double4::broadcast(ray.shear_x)),
        shear_y(Double4::broadcast(ray.shear_y)),
        direction_z(Double4::broadcast(ray.direction_z)) {}

  std::int64_t x_axis, y_axis, z_axis;
  Double4 origin_x, origin_y, origin_z, shear_x, shear_y, direction_z;
};

// The hits of one ray with one packet.
class PacketHits {
 public:
  PacketHits(const PacketRay& ray, const BvhPacket& packet) {
    Double4 x[3], y[3], z[3];
    for (int i = 0; i < 3; ++i) {
      z[i] = Double4::load(packet.corners[i][ray.z_axis]) - ray.origin_z;
      x[i] = Double4::load(packet.corners[i][ray.x_axis]) - ray.origin_x - ray.shear_x * z[i];
      y[i] = Double4::load(packet.corners[i][ray.y_axis]) - ray.origin_y - ray.shear_y * z[i];
    }
    const Double4 e0 = difference_of_products(x[1], y[2], y[1], x[2]);
    const Double4 e1 = difference_of_products(x[2], y[0], y[2], x[0]);
    const Double4 e2 = difference_of_products(x[0], y[1], y[0], x[1]);
    const Double4 zero = Double4::broadcast(0);
    const unsigned any_negative = less(min(min(e0, e1), e2), zero);
    const unsigned any_positive = less(zero, max(max(e0, e1), e2));
    lanes_ = packet.triangle_lanes & ~(any_negative & any_positive);
    if (lanes_ == 0) return;

    const Double4 det = e0 + e1 + e2;
    const Double4 scale = det * ray.direction_z;
    const Double4 t = (e0 * z[0] + e1 * z[1] + e2 * z[2]) / scale;
    // All corners ahead, or all behind: z and direction_z have the same sign where their product is positive.
    const Double4 ahead = min(min(z[0] * ray.direction_z, z[1] * ray.direction_z), z[2] * ray.direction_z);
    lanes_ &= less(zero, t);  // not if det is 0
    if ((lanes_ & ~less(zero, ahead)) != 0)
      lanes_ &= less(zero, ahead) | less(t_error(x, y, z, e0, e1, e2, scale), t);
    t.store(t_);
    e1.store(e1_);
    e2.store(e2_);
    det.store(det_);
  }

  unsigned lanes() const { return lanes_; }
  float t(int lane) const { return static_cast<float>(t_[lane]); }
  float b1(int lane) const { return static_cast<float>(e1_[lane] / det_[lane]); }
  float b2(int lane) const { return static_cast<float>(e2_[lane] / det_[lane]); }

 private:
  static Double4 difference_of_products(Double4 a, Double4 b, Double4 c, Double4 d) {
    const Double4 cd = c * d;
    const Double4 error_of_cd = negative_multiply_add(c, d, cd);
    return multiply_subtract(a, b, cd) + error_of_cd;
  }

  static Double4 max_abs(Double4 a, Double4 b, Double4 c) { return max(max(abs(a), abs(b)), abs(c)); }

  static Double4 t_error(const Double4* x, const Double4* y, const Double4* z, Double4 e0, Double4 e1,
                         Double4 e2, Double4 scale) {
    const Double4 max_x = max_abs(x[0], x[1], x[2]), max_y = max_abs(y[0], y[1], y[2]);
    const Double4 max_z = max_abs(z[0], z[1], z[2]), max_e = max_abs(e0, e1, e2);
    const auto times_gamma = [](int n, Double4 a) { return Double4::broadcast(gamma<double>(n)) * a; };
    const Double4 delta_x = times_gamma(5, max_x + max_z);
    const Double4 delta_y = times_gamma(5, max_y + max_z);
    const Double4 delta_z = times_gamma(3, max_z);
    const Double4 delta_e =
        Double4::broadcast(2) * (times_gamma(2, max_x) * max_y + delta_y * max_x + delta_x * max_y);
    const Double4 bound =
        Double4::broadcast(3) * (times_gamma(3, max_e) * max_z + delta_e * max_z + delta_z * max_e);
    return bound / abs(scale);
  }

  unsigned lanes_;
  alignas(32) double t_[BvhPacket::kWidth], e1_[BvhPacket::kWidth], e2_[BvhPacket::kWidth],
      det_[BvhPacket::kWidth];
};

}  // namespace tessera::core
