// What the rays of a group hit. A triangle that float arithmetic is sure about (triangle_filter.hpp) becomes
// a ray's candidate, with bounds on its t; only where bounds overlap, and for the candidate that is left in
// the end, is the hit computed in double, four at once.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <span>

#include "core/accel/bvh.hpp"
#include "core/accel/bvh_layout.hpp"
#include "core/accel/ray_group.hpp"
#include "core/accel/ray_traversal.hpp"
#include "core/accel/sheared_group.hpp"
#include "core/geometry/primitives.hpp"
#include "core/geometry/rounding.hpp"
#include "core/math/lane_array.hpp"

namespace tessera::core {

// What a group is traced against: a scene or an object.
struct GroupScene {
  const Primitives& primitives;
  const Bvh::Arrays* objects;  // of a scene: the trees of those that instances show
  const BvhNode* nodes;
  const BvhPacket* packets;
};

template <Query kQuery, typename AnyRay>
class GroupHits {
 public:
  using Columns = RayColumns<AnyRay>;

  // Keeps references, and tells `group` how far its rays reach.
  GroupHits(const GroupScene& scene, const Columns& columns, RayGroup<AnyRay>& group)
      : scene_(scene), columns_(columns), group_(group), sheared_(columns), alive_(columns.all()) {
    for (std::size_t i = 0; i < kLanes * columns.vectors(); i += kLanes) {
      const Float8 t_max = Float8::load(columns.t_max + i);
      t_max.store(t_low_ + i);
      min(t_max, Float8(std::numeric_limits<float>::infinity())).store(t_high_ + i);
      Float8(std::bit_cast<float>(kNothing)).store(candidates_ + i);
    }
  }

  // Those whose answer is still open: for kAny, those that are not known to hit anything.
  RaySet alive() const { return alive_; }
  // Ray i hits nothing at this t or beyond that would improve on what it hits.
  float reach(std::size_t i) const {
    // What is as near may come first.
    return kQuery == Query::kAny ? columns_.t_max[i] : std::min(columns_.t_max[i], next_float_up(t_high_[i]));
  }

  // The rays of `set` against a packet's spheres, eight rays at once.
  void test_spheres(const BvhPacket& packet, RaySet set) {
    for (unsigned spheres = packet.sphere_lanes; spheres != 0; spheres &= spheres - 1) {
      const std::uint32_t primitive = packet.primitives[std::countr_zero(spheres)];
      for (std::size_t v = 0; v < columns_.vectors(); ++v)
        if (lanes_of(set, v) != 0) test_sphere(primitive, v, Mask8::from_bits(lanes_of(set, v)));
    }
  }

  // The rays of `set` against all triangles of packet `index`, each ray by itself.
  void test_each(std::uint32_t index, RaySet set) {
    for_each_ray(set, [&](std::size_t i) { test_later(i, index); });
    settle();
  }

  // Ray i against all triangles of packet `index`; known after the next settle() at the latest. Without
  // branches but for rays that may hit several: which may hit one cannot be guessed.
  void test_later(std::size_t i, std::uint32_t index) {
    if (queued_ > kQueueSize - BvhPacket::kWidth - kSize) settle();  // which adds one for each ray at most
    const BvhPacket& packet = scene_.packets[index];
    unsigned lanes = packet.triangle_lanes &
                     TriangleHits::may_hit(sheared_.rays_like(i), t_high_[i], [&](int corner, int axis) {
                       return Double4::load(packet.corners[corner][sheared_.axis(i, axis)]);
                     });
    // Written in any case; the queue's end moves on only if there is one.
    const std::size_t before = queued_;
    enqueue(i, index, std::countr_zero(lanes));
    queued_ = before + (lanes != 0);
    for (lanes &= lanes - 1; lanes != 0; lanes &= lanes - 1) enqueue(i, index, std::countr_zero(lanes));
  }

  // The rays of `set` against all triangles of packet `index`, eight rays at once. Only where
  // RayGroup::can_filter.
  void test_together(std::uint32_t index, RaySet set) {
    for (std::size_t v = 0; v < columns_.vectors(); ++v)
      if (lanes_of(set, v) != 0) test_vector(index, v, Mask8::from_bits(lanes_of(set, v)));
    settle();
  }

  // Computes what is queued. A ray whose candidate came after it was queued is queued again.
  void settle() {
    for (std::size_t begin = 0, count; begin < queued_; begin += count) {
      count = std::min<std::size_t>(4, queued_ - begin);
      std::array<Pair, 4> pairs;
      std::array<std::size_t, 4> rays;
      for (std::size_t k = 0; k < 4; ++k) {
        pairs[k] = queue_[begin + std::min(k, count - 1)];
        rays[k] = pairs[k].ray;
      }
      const TriangleHits hits(sheared_.rays(rays), Corners(*this, pairs));
      if (hits.lanes() != 0) {
        for_each_hit(hits, pairs, (RaySet{1} << count) - 1,
                     [&](std::size_t i, const Hit& hit) { improve_hit(i, hit); });
      }
      for (std::size_t k = 0; k < count; ++k) {
        update(rays[k]);
        enqueue_candidate(rays[k]);
      }
    }
    queued_ = 0;
  }

  // Computes the candidates of the rays of `set`, four at once.
  void settle_candidates(RaySet set) {
    for_each_ray(set, [&](std::size_t i) { enqueue_candidate(i); });
    settle();
  }

  // The rays of `set` hit hit_of(i), unless they hit something better.
  template <typename HitOf>
  void improve_all(RaySet set, const HitOf& hit_of) {
    settle_candidates(set);
    for_each_ray(set, [&](std::size_t i) {
      improve_hit(i, hit_of(i));
      update(i);
    });
  }
  // For kAny: the rays of `set` hit something.
  void occlude(RaySet set) { alive_ &= ~set; }

  // What the rays hit, after all has been tested.
  std::span<const Hit> finish() {
    for (std::size_t first = 0; first < columns_.count; first += 4) {
      std::array<Pair, 4> pairs;
      RaySet open = 0;
      for (std::size_t k = 0; k < 4; ++k) {
        open |= RaySet{has_candidate(first + k)} << k;
        pairs[k] = {static_cast<std::uint32_t>(first + k),
                    has_candidate(first + k) ? candidate(first + k) : 0};
      }
      if (open == 0) continue;
      const TriangleHits hits(sheared_.rays(first), Corners(*this, pairs), TriangleHits::Certain());
      for_each_hit(hits, pairs, open, [&](std::size_t i, const Hit& hit) { hits_[i] = hit; });
    }
    return std::span(hits_).first(columns_.count);
  }

 private:
  static constexpr std::size_t kSize = Columns::kSize, kLanes = Columns::kLanes;
  static constexpr std::uint32_t kNothing = 0xffffffffu;
  // Tested together, a packet adds two for each ray and triangle at most, and settling one for each ray.
  static constexpr std::size_t kQueueSize = 3 * kSize * BvhPacket::kWidth;

  struct Pair {
    std::uint32_t ray;
    std::uint32_t triangle;  // its packet's index times BvhPacket::kWidth, and its lane
  };

  bool has_candidate(std::size_t i) const { return candidate(i) != kNothing; }
  std::uint32_t candidate(std::size_t i) const { return std::bit_cast<std::uint32_t>(candidates_[i]); }

  void test_sphere(std::uint32_t primitive, std::size_t v, Mask8 asked) {
    using Wide = Vec3dOf<Double8>;
    const auto column = [v](const auto& values, int axis) {
      return in_double(Columns::Lanes::load(values[axis] + kLanes * v));
    };
    const auto wide = [&](const auto& values) {
      return Wide(column(values, 0), column(values, 1), column(values, 2));
    };
    const Sphere& sphere = scene_.primitives.sphere(primitive);
    const Vec3 center = sphere.center;
    const auto [found, exact_t] = intersect_sphere<Float8>(wide(columns_.origin), wide(columns_.direction),
                                                           {{center.x, center.y, center.z}, sphere.radius});
    const Float8 t = to_float(exact_t);
    const Mask8 hit = asked & found & (t > 0);
    if (kQuery == Query::kAny) {
      alive_ &= ~to_set((hit & (t < Float8::load(columns_.t_max + kLanes * v))).bits(), v);
      return;
    }
    const FloatLanes distances(t);
    for_each_ray(to_set((hit & (t <= Float8::load(t_high_ + kLanes * v))).bits(), v), [&](std::size_t i) {
      settle_candidate(i);
      improve_hit(i, {distances[i % kLanes], primitive, 0, 0});
      update(i);
    });
  }

  // Without branches but for triangles that none of the rays hits and for what is not sure: how many of the
  // rays hit a triangle cannot be guessed.
  void test_vector(std::uint32_t index, std::size_t v, Mask8 asked) {
    const BvhPacket& packet = scene_.packets[index];
    const FilterRays rays = group_.filter_rays(v);
    const int* axes = group_.filter_axes();
    float* const t_low = t_low_ + kLanes * v;
    float* const t_high = t_high_ + kLanes * v;
    float* const candidates = candidates_ + kLanes * v;
    for (unsigned triangles = packet.triangle_lanes; triangles != 0; triangles &= triangles - 1) {
      const int lane = std::countr_zero(triangles);
      const std::uint32_t triangle = index * BvhPacket::kWidth + static_cast<std::uint32_t>(lane);
      const TriangleFilter filter(
          rays, [&](int corner, int axis) { return Float8(packet.corners[corner][axes[axis]][lane]); });
      const Mask8 may_hit = asked & !filter.surely_outside();
      if (!any(may_hit)) continue;
      const Mask8 inside = filter.surely_inside();
      const auto [low, high] = filter.t(rays);
      const Float8 best_low = Float8::load(t_low), best_high = Float8::load(t_high);
      const Mask8 worse = inside & ((high < Float8(0)) | (best_high < low));
      const Mask8 better = asked & inside & (Float8(0) < low) & (high < best_low);
      if (kQuery == Query::kAny) {
        alive_ &= ~to_set(better.bits(), v);
      } else {
        select(better, low, best_low).store(t_low);
        select(better, high, best_high).store(t_high);
        select(better, Float8(std::bit_cast<float>(triangle)), Float8::load(candidates)).store(candidates);
      }
      for_each_ray(to_set((may_hit & !worse & !better).bits(), v), [&](std::size_t i) {
        enqueue_candidate(i);
        queue_[queued_++] = {static_cast<std::uint32_t>(i), triangle};
      });
    }
    if (kQuery == Query::kClosest) group_.set_limits(v, Float8::load(t_high));
  }

  void enqueue(std::size_t i, std::uint32_t packet, int lane) {
    queue_[queued_++] = {static_cast<std::uint32_t>(i),
                         packet * BvhPacket::kWidth + static_cast<std::uint32_t>(lane)};
  }

  void enqueue_candidate(std::size_t i) {
    if (!has_candidate(i)) return;
    queue_[queued_++] = {static_cast<std::uint32_t>(i), candidate(i)};
    candidates_[i] = std::bit_cast<float>(kNothing);
  }

  void settle_candidate(std::size_t i) {
    enqueue_candidate(i);
    settle();
  }

  // The corners of four pairs' triangles, along the axes of their rays.
  class Corners {
   public:
    Corners(const GroupHits& hits, const std::array<Pair, 4>& pairs) {
      for (std::size_t k = 0; k < 4; ++k)
        for (std::size_t axis = 0; axis < 3; ++axis)
          coordinates_[k][axis] =
              hits.packet_of(pairs[k]).corners[0][hits.sheared_.axis(pairs[k].ray, static_cast<int>(axis))] +
              pairs[k].triangle % BvhPacket::kWidth;
    }
    Double4 operator()(int corner, int axis) const {
      const auto at = [&](std::size_t k) {
        return coordinates_[k][static_cast<std::size_t>(axis)][3 * BvhPacket::kWidth * corner];
      };
      return Double4::of(at(0), at(1), at(2), at(3));
    }

   private:
    std::array<std::array<const float*, 3>, 4> coordinates_;  // of the first corner
  };

  const BvhPacket& packet_of(const Pair& pair) const {
    return scene_.packets[pair.triangle / BvhPacket::kWidth];
  }

  // Lets improve(ray, hit) have the hits of those pairs that are in `open`.
  template <typename Improve>
  void for_each_hit(const TriangleHits& hits, const std::array<Pair, 4>& pairs, RaySet open,
                    const Improve& improve) const {
    alignas(16) float t[4], b1[4], b2[4];
    hits.store(t, b1, b2);
    for_each_ray(open & hits.lanes(), [&](std::size_t k) {
      const std::uint32_t primitive = packet_of(pairs[k]).primitives[pairs[k].triangle % BvhPacket::kWidth];
      improve(pairs[k].ray, Hit{t[k], primitive, b1[k], b2[k]});
    });
  }

  void improve_hit(std::size_t i, const Hit& hit) { hits_[i].improve(columns_.ray(i), hit); }

  // After hits_[i] may have changed.
  void update(std::size_t i) {
    if (kQuery == Query::kAny) {
      if (hits_[i].found()) alive_ &= ~(RaySet{1} << i);
      return;
    }
    // A t_max that is NaN stays so in t_low_, and nothing is sure of such a ray.
    t_low_[i] = std::min(columns_.t_max[i], hits_[i].t);
    t_high_[i] = std::min(hits_[i].t, columns_.t_max[i]);
    group_.set_limit(i, box_limit(t_high_[i]));
  }

  const GroupScene& scene_;
  const Columns& columns_;
  RayGroup<AnyRay>& group_;
  ShearedGroup sheared_;
  RaySet alive_;
  // Bounds on t of the best hit that is known, candidate or not; t_max where there is none.
  alignas(32) float t_low_[kSize];
  alignas(32) float t_high_[kSize];
  alignas(32) float candidates_[kSize];  // triangles, as the bits of floats; each nearer than hits_
  std::array<Hit, kSize> hits_;
  std::array<Pair, kQueueSize> queue_;
  std::size_t queued_ = 0;
};

}  // namespace tessera::core
