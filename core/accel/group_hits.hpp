// SPDX-License-Identifier: Apache-2.0
// The hits of a group's rays. A triangle that the float filter accepts (triangle_filter.hpp) becomes a
// ray's candidate, with bounds on its t. The exact hit is computed in double, a vector at once, only
// where bounds overlap and for the last remaining candidate.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <span>

#include "core/accel/bvh.hpp"
#include "core/accel/bvh_layout.hpp"
#include "core/accel/hit_columns.hpp"
#include "core/accel/packet_hits.hpp"
#include "core/accel/ray_group.hpp"
#include "core/accel/ray_traversal.hpp"
#include "core/accel/sheared_group.hpp"
#include "core/geometry/primitives.hpp"
#include "core/geometry/rounding.hpp"

namespace tessera::core::accel {

// The geometry that a group is traced against: a scene or an object.
struct GroupScene {
  const Primitives& primitives;
  const Bvh::Arrays* objects;  // for a scene: the trees of its instanced objects
  const BvhNode* nodes;
  const BvhPacket* packets;
  OpacityOf opacity;
};

template <Query kQuery, typename AnyRay>
class GroupHits {
 public:
  using Columns = RayColumns<AnyRay>;

  // Keeps references, and sets the ray limits of `group`.
  GroupHits(const GroupScene& scene, const Columns& columns, RayGroup<AnyRay>& group)
      : scene_(scene), columns_(columns), group_(group), sheared_(columns), alive_(columns.all()) {
    for (std::size_t i = 0; i < kLanes * columns.vectors(); i += kLanes) {
      const FloatVector t_max = FloatVector::load(columns.t_max + i);
      t_max.store(t_low_ + i);
      min(t_max, FloatVector(std::numeric_limits<float>::infinity())).store(t_high_ + i);
      FloatVector(std::bit_cast<float>(kNothing)).store(candidates_ + i);
    }
  }

  // The rays that are still open; for kAny, those not known to hit anything opaque.
  RaySet alive() const { return alive_; }
  // For kAny: the rays that have met something partly opaque.
  RaySet partly_occluded() const { return partly_occluded_; }
  // An upper bound on useful distances: hits of ray i at or beyond it do not improve its result.
  float reach(std::size_t i) const {
    // An equally near hit may still win the tie.
    return kQuery == Query::kAny ? columns_.t_max[i] : std::min(columns_.t_max[i], next_float_up(t_high_[i]));
  }

  // Tests the rays of `set` against a packet's spheres, one vector of rays at a time if they are opaque.
  void test_spheres(const BvhPacket& packet, RaySet set) {
    if (decides_opacity(packet)) return test_others(packet, set);
    for_each_lane(packet.lanes, [&](std::size_t lane) {
      for (std::size_t v = 0; v < columns_.vectors(); ++v)
        if (lanes_of(set, v) != 0)
          test_sphere(packet.primitives[lane], v, MaskVector::from_bits(lanes_of(set, v)));
    });
  }

  // Tests the rays of `set` against a packet's curves. Those that a ray comes near are prefetched and queued;
  // the result is known after the next settle() at the latest.
  void test_curves_later(const BvhPacket& packet, RaySet set) {
    for_each_ray(set, [&](std::size_t i) {
      if (queued_curves_ > kCurveQueueSize - BvhPacket::kWidth) settle_curves();
      for_each_lane(curves_near(packet, ObjectRay(columns_.ray(i)), group_.limit(i)), [&](std::size_t lane) {
        const Curves::Source source = source_of(packet, lane);
        scene_.primitives.prefetch_curve(source);
        curve_queue_[queued_curves_++] = {static_cast<std::uint32_t>(i), packet.primitives[lane], source,
                                          &packet};
      });
    });
  }

  // Tests the rays of `set` against a packet's primitives, ray by ray; not for triangles at rest, curves or
  // instances.
  void test_others(const BvhPacket& packet, RaySet set) {
    for_each_ray(set, [&](std::size_t i) {
      const AnyRay ray = columns_.ray(i);
      for_each_line_hit(packet, scene_.primitives, ray, group_.limit(i), [&](const Hit& found) {
        Hit hit;
        if (hit.improve(ray, found)) accept(i, packet, hit);
      });
    });
  }

  // Tests the rays of `set` against all triangles of packet `index`, ray by ray.
  void test_each(std::uint32_t index, RaySet set) {
    for_each_ray(set, [&](std::size_t i) { test_later(i, index); });
    settle();
  }

  // Tests ray i against all triangles of packet `index`; the result is known after the next settle() at the
  // latest. Branches only where a ray may hit several triangles: whether it hits one is unpredictable.
  void test_later(std::size_t i, std::uint32_t index) {
    if (queued_ > kQueueSize - BvhPacket::kWidth - kSize) settle();  // a test adds at most kSize
    const BvhPacket& packet = scene_.packets[index];
    unsigned lanes =
        packet.lanes &
        TriangleHitsOf<DoubleHalf>::may_hit(sheared_.rays_like(i), t_high_[i], [&](int corner, int axis) {
          return DoubleHalf::load(packet.corners[corner][sheared_.axis(i, axis)]);
        });
    // Writes unconditionally; the end of the queue advances only if there is an entry.
    const std::size_t before = queued_;
    enqueue(i, index, std::countr_zero(lanes));
    queued_ = before + (lanes != 0);
    for (lanes &= lanes - 1; lanes != 0; lanes &= lanes - 1) enqueue(i, index, std::countr_zero(lanes));
  }

  // Tests the rays of `set` against all triangles of packet `index`, one vector of rays at a time. Requires
  // RayGroup::can_filter.
  void test_together(std::uint32_t index, RaySet set) {
    if (decides_opacity(scene_.packets[index])) {
      test_vectors<false>(index, set);
    } else {
      test_vectors<true>(index, set);
    }
    settle();
  }

  // Computes the queued hits.
  void settle() {
    settle_curves();
    settle_triangles();
  }

  // Computes the candidates of the rays of `set`, four at once.
  void settle_candidates(RaySet set) {
    for_each_ray(set, [&](std::size_t i) { enqueue_candidate(i); });
    settle_triangles();
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
  // For kAny: marks the rays of `set` as occluded.
  void occlude(RaySet set) { alive_ &= ~set; }
  void occlude_partly(RaySet set) { partly_occluded_ |= set; }

  // The final hits, once everything has been tested.
  const HitColumns& finish() {
    if (kQuery == Query::kAny) return hits_;  // kAny keeps no candidates
    using D = DoubleRegister;
    for (std::size_t first = 0; first < columns_.count; first += D::kLanes) {
      Pairs<D> pairs;
      RaySet open = 0;
      for (std::size_t k = 0; k < D::kLanes; ++k) {
        open |= RaySet{has_candidate(first + k)} << k;
        pairs[k] = {static_cast<std::uint32_t>(first + k),
                    has_candidate(first + k) ? candidate(first + k) : 0};
      }
      if (open == 0) continue;
      const TriangleHitsOf<D> hits(sheared_.rays<D>(first),
                                   sheared_.corners<D>(lanes_of_packets<D>(pairs), first),
                                   typename TriangleHitsOf<D>::Certain());
      if (open == (RaySet{1} << D::kLanes) - 1) {
        const HitColumns::Places kept = hits_.from(first);
        hits.store(kept.t, kept.b1, kept.b2);
        for (std::size_t k = 0; k < D::kLanes; ++k) kept.primitive[k] = primitive_of(pairs[k]);
        std::fill_n(kept.instance, D::kLanes, kNoInstance);
      } else {
        for_each_hit(hits, pairs, open, [&](const Pair& pair, const Hit& hit) { hits_.set(pair.ray, hit); });
      }
    }
    return hits_;
  }

 private:
  static constexpr std::size_t kSize = Columns::kSize, kLanes = Columns::kLanes;
  static constexpr std::uint32_t kNothing = 0xffffffffu;
  // A packet test adds at most two entries for each ray and triangle, and settling one for each ray.
  static constexpr std::size_t kQueueSize = 3 * kSize * BvhPacket::kWidth;
  static constexpr std::size_t kCurveQueueSize = kSize * BvhPacket::kWidth;

  struct Pair {
    std::uint32_t ray;
    std::uint32_t triangle;  // packet index * BvhPacket::kWidth + lane
  };
  // A part of a curve that a ray comes near.
  struct NearCurve {
    std::uint32_t ray, primitive;
    Curves::Source source;
    const BvhPacket* packet;
  };
  // One pair in each lane of D.
  template <typename D>
  using Pairs = std::array<Pair, D::kLanes>;

  bool has_candidate(std::size_t i) const { return candidate(i) != kNothing; }
  std::uint32_t candidate(std::size_t i) const { return std::bit_cast<std::uint32_t>(candidates_[i]); }

  void test_sphere(std::uint32_t primitive, std::size_t v, MaskVector asked) {
    using Wide = Vec3dOf<DoubleVector>;
    const auto column = [v](const auto& values, int axis) {
      return in_double(Columns::Lanes::load(values[axis] + kLanes * v));
    };
    const auto wide = [&](const auto& values) {
      return Wide(column(values, 0), column(values, 1), column(values, 2));
    };
    const Sphere& sphere = scene_.primitives.sphere(primitive);
    const Vec3 center = sphere.center;
    const auto [found, exact_t] = intersect_sphere<FloatVector>(
        wide(columns_.origin), wide(columns_.direction), {{center.x, center.y, center.z}, sphere.radius});
    const FloatVector t = to_float(exact_t);
    const MaskVector hit = asked & found & (t > 0);
    if (kQuery == Query::kAny) {
      alive_ &= ~to_set((hit & (t < FloatVector::load(columns_.t_max + kLanes * v))).bits(), v);
      return;
    }
    alignas(kVectorAlignment) float distances[kLanes];
    t.store(distances);
    for_each_ray(to_set((hit & (t <= FloatVector::load(t_high_ + kLanes * v))).bits(), v),
                 [&](std::size_t i) {
                   settle_candidate(i);
                   improve_hit(i, {distances[i % kLanes], primitive, 0, 0});
                   update(i);
                 });
  }

  // Takes into account what ray i has hit, other than a triangle at rest.
  void accept(std::size_t i, const BvhPacket& packet, const Hit& hit) {
    if (kQuery == Query::kClosest) {
      if (!(hit.t <= t_high_[i])) return;
      settle_candidate(i);
    }
    improve_hit(i, packet, hit);
    update(i);
  }

  bool decides_opacity(const BvhPacket& packet) const {
    return scene_.opacity.template decides<kQuery>(packet);
  }

  template <bool kOpaque>
  void test_vectors(std::uint32_t index, RaySet set) {
    for (std::size_t v = 0; v < columns_.vectors(); ++v)
      if (lanes_of(set, v) != 0) test_vector<kOpaque>(index, v, MaskVector::from_bits(lanes_of(set, v)));
  }

  // Branches only for triangles that no ray hits and for uncertain results: how many rays hit a triangle is
  // unpredictable. Unless the triangles are opaque, no hit is certain.
  template <bool kOpaque>
  void test_vector(std::uint32_t index, std::size_t v, MaskVector asked) {
    const BvhPacket& packet = scene_.packets[index];
    const FilterRays rays = group_.filter_rays(v);
    const int* axes = group_.filter_axes();
    float* const t_low = t_low_ + kLanes * v;
    float* const t_high = t_high_ + kLanes * v;
    float* const candidates = candidates_ + kLanes * v;
    for (unsigned triangles = packet.lanes; triangles != 0; triangles &= triangles - 1) {
      const int lane = std::countr_zero(triangles);
      const std::uint32_t triangle = index * BvhPacket::kWidth + static_cast<std::uint32_t>(lane);
      const TriangleFilter filter(
          rays, [&](int corner, int axis) { return FloatVector(packet.corners[corner][axes[axis]][lane]); });
      const MaskVector may_hit = asked & !filter.surely_outside();
      if (!any(may_hit)) continue;
      const MaskVector inside = filter.surely_inside();
      const auto [low, high] = filter.t(rays);
      const FloatVector best_low = FloatVector::load(t_low), best_high = FloatVector::load(t_high);
      const MaskVector worse = inside & ((high < FloatVector(0)) | (best_high < low));
      MaskVector open = may_hit & !worse;
      if (kOpaque) {
        const MaskVector better = asked & inside & (FloatVector(0) < low) & (high < best_low);
        open = open & !better;
        if (kQuery == Query::kAny) {
          alive_ &= ~to_set(better.bits(), v);
        } else {
          select(better, low, best_low).store(t_low);
          select(better, high, best_high).store(t_high);
          select(better, FloatVector(std::bit_cast<float>(triangle)), FloatVector::load(candidates))
              .store(candidates);
        }
      }
      for_each_ray(to_set(open.bits(), v), [&](std::size_t i) {
        enqueue_candidate(i);
        queue_[queued_++] = {static_cast<std::uint32_t>(i), triangle};
      });
    }
    if (kQuery == Query::kClosest) group_.set_limits(v, FloatVector::load(t_high));
  }

  // A ray whose candidate arrived after it was queued is queued again.
  void settle_triangles() {
    using D = DoubleHalf;  // few entries are expected
    for (std::size_t begin = 0, count; begin < queued_; begin += count) {
      count = std::min(D::kLanes, queued_ - begin);
      Pairs<D> pairs;
      std::array<std::size_t, D::kLanes> rays;
      for (std::size_t k = 0; k < D::kLanes; ++k) {
        pairs[k] = queue_[begin + std::min(k, count - 1)];
        rays[k] = pairs[k].ray;
      }
      const TriangleHitsOf<D> hits(sheared_.rays<D>(rays),
                                   sheared_.corners<D>(lanes_of_packets<D>(pairs), rays));
      if (hits.lanes() != 0) {
        for_each_hit(hits, pairs, (RaySet{1} << count) - 1,
                     [&](const Pair& pair, const Hit& hit) { improve_hit(pair.ray, packet_of(pair), hit); });
      }
      for (std::size_t k = 0; k < count; ++k) {
        update(rays[k]);
        enqueue_candidate(rays[k]);
      }
    }
    queued_ = 0;
  }

  void settle_curves() {
    for (std::size_t k = 0; k < queued_curves_; ++k) {
      const auto& [i, primitive, source, packet] = curve_queue_[k];
      if ((alive_ >> i & 1) == 0) continue;
      const AnyRay ray = columns_.ray(i);
      const auto found = scene_.primitives.curve_line_hit(primitive, source, ray);
      Hit hit;
      if (found && hit.improve(ray, *found)) accept(i, *packet, hit);
    }
    queued_curves_ = 0;
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
    settle_triangles();
  }

  const BvhPacket& packet_of(const Pair& pair) const {
    return scene_.packets[pair.triangle / BvhPacket::kWidth];
  }
  template <typename D>
  typename ShearedGroup::Corners<D>::Lanes lanes_of_packets(const Pairs<D>& pairs) const {
    typename ShearedGroup::Corners<D>::Lanes lanes;
    for (std::size_t k = 0; k < D::kLanes; ++k)
      lanes[k] = packet_of(pairs[k]).corners[0][0] + pairs[k].triangle % BvhPacket::kWidth;
    return lanes;
  }

  std::uint32_t primitive_of(const Pair& pair) const {
    return packet_of(pair).primitives[pair.triangle % BvhPacket::kWidth];
  }

  // Calls improve(pair, hit) with the hits of the pairs in `open`.
  template <typename D, typename Improve>
  void for_each_hit(const TriangleHitsOf<D>& hits, const Pairs<D>& pairs, RaySet open,
                    const Improve& improve) const {
    alignas(kVectorAlignment) float t[D::kLanes], b1[D::kLanes], b2[D::kLanes];
    hits.store(t, b1, b2);
    for_each_ray(open & hits.lanes(), [&](std::size_t k) {
      improve(pairs[k], Hit{t[k], primitive_of(pairs[k]), b1[k], b2[k]});
    });
  }

  void improve_hit(std::size_t i, const Hit& hit) {
    Hit best = hits_[i];
    if (best.improve(columns_.ray(i), hit)) hits_.set(i, best);
  }
  // The same for a hit of one of the packet's primitives, if that is opaque enough.
  void improve_hit(std::size_t i, const BvhPacket& packet, const Hit& hit) {
    Hit best = hits_[i];
    if (!best.improve(columns_.ray(i), hit)) return;
    if (decides_opacity(packet)) {
      const Opacity opacity = scene_.opacity.at(hit, columns_.time[i]);
      if (opacity == Opacity::kTransparent) return;
      if (kQuery == Query::kAny && opacity == Opacity::kPartial) return occlude_partly(RaySet{1} << i);
    }
    hits_.set(i, best);
  }

  // Updates the bounds of ray i after hits_[i] may have changed.
  void update(std::size_t i) {
    if (kQuery == Query::kAny) {
      if (hits_.found(i)) alive_ &= ~(RaySet{1} << i);
      return;
    }
    // A NaN t_max stays NaN in t_low_, so nothing is certain for such a ray.
    t_low_[i] = std::min(columns_.t_max[i], hits_.t(i));
    t_high_[i] = std::min(hits_.t(i), columns_.t_max[i]);
    group_.set_limit(i, box_limit(t_high_[i]));
  }

  const GroupScene& scene_;
  const Columns& columns_;
  RayGroup<AnyRay>& group_;
  ShearedGroup sheared_;
  RaySet alive_, partly_occluded_ = 0;
  // Bounds on t of the best known hit, candidate or not; t_max if there is none.
  alignas(kVectorAlignment) float t_low_[kSize];
  alignas(kVectorAlignment) float t_high_[kSize];
  // Triangle ids, stored as the bits of floats; each candidate is nearer than hits_.
  alignas(kVectorAlignment) float candidates_[kSize];
  HitColumns hits_;
  std::array<Pair, kQueueSize> queue_;
  std::size_t queued_ = 0;
  std::array<NearCurve, kCurveQueueSize> curve_queue_;
  std::size_t queued_curves_ = 0;
};

}  // namespace tessera::core::accel
