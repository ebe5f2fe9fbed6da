#include "core/accel/group_traversal.hpp"

#include <algorithm>
#include <bit>

#include "core/accel/box_test.hpp"
#include "core/geometry/triangle.hpp"

namespace tessera::core {
namespace {

constexpr std::size_t kSize = RayGroup::kSize, kLanes = RayGroup::kLanes;

// What the tests cost, in cycles, as far as choosing between them goes.
constexpr int kBoxVsVector = 9, kRayVsBoxes = 20, kTriangleVsVector = 24, kRayVsPacket = 40;
constexpr int kFewRays = 3;

class GroupTraversal {
 public:
  GroupTraversal(const GroupScene& scene, std::span<const Ray> rays, std::span<const std::uint32_t> order)
      : scene_(scene), rays_(rays), order_(order), group_(rays, order), alive_(group_.all()) {
    for (std::size_t i = 0; i < order.size(); ++i) {
      sheared_[i] = ShearedRay(ray(i));
      hits_[i] = {};
    }
    for (std::size_t i = 0; i < kSize; ++i) {
      t_low_[i] = ray(std::min(i, order.size() - 1)).t_max;
      t_high_[i] = std::min(std::numeric_limits<float>::infinity(), t_low_[i]);
      pending_[i] = std::bit_cast<float>(kNothing);
    }
  }

  template <Query kQuery>
  void run() {
    stack_[0] = {0, BvhChild::node(0), alive_};
    size_ = 1;
    while (size_ > 0) {
      const Entry entry = stack_[--size_];
      RaySet set = entry.rays & alive_;
      if (set != 0) set = group_.reaching(set, entry.t_near);
      if (set == 0) continue;
      const int count = std::popcount(set);
      if (entry.child.is_packet()) {
        visit<kQuery>(entry.child.index(), set, count);
      } else if (count <= kFewRays) {
        for (RaySet s = set; s != 0; s &= s - 1)
          go_alone<kQuery>(static_cast<std::size_t>(std::countr_zero(s)), entry.child);
      } else {
        enter(scene_.nodes[entry.child.index()], set, count);
      }
    }
    if (kQuery == Query::kClosest) {
      for (std::size_t i = 0; i < order_.size(); ++i) enqueue_pending(i);
      settle<kQuery>();
    }
  }

  // After run.
  const Hit& hit(std::size_t i) const { return hits_[i]; }
  bool occluded(std::size_t i) const { return (alive_ >> i & 1) == 0; }

 private:
  struct Entry {
    float t_near;  // no ray of the group enters before
    BvhChild child;
    RaySet rays;
  };
  static constexpr std::uint32_t kNothing = 0xffffffffu;

  const Ray& ray(std::size_t i) const { return rays_[order_[i]]; }

  void enter(const BvhNode& node, RaySet set, int count) {
    alignas(32) float t_near[BvhNode::kWidth];
    unsigned met = group_.boxes_met(node, t_near);
    int vectors = 0;
    for (std::size_t v = 0; v < RayGroup::kVectors; ++v) vectors += RayGroup::lanes(set, v) != 0;
    const std::size_t base = size_;
    if (std::popcount(met) * vectors * kBoxVsVector <= count * kRayVsBoxes) {
      for (; met != 0; met &= met - 1) {
        const int lane = std::countr_zero(met);
        const RaySet meeting = group_.rays_meeting(node, lane, set);
        if (meeting != 0) push(base, {t_near[lane], node.children[static_cast<std::size_t>(lane)], meeting});
      }
    } else {
      std::array<RaySet, BvhNode::kWidth> meeting;
      unsigned any = transposed(node, set, meeting);
      for (; any != 0; any &= any - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(any));
        push(base, {t_near[lane], node.children[lane], meeting[lane]});
      }
    }
  }

  unsigned transposed(const BvhNode& node, RaySet set, std::array<RaySet, BvhNode::kWidth>& meeting) {
    alignas(32) std::uint8_t low[kSize] = {}, high[kSize] = {};
    unsigned any = 0;
    for (RaySet s = set; s != 0; s &= s - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(s));
      const unsigned met = group_.boxes_met_by(i, node);
      low[i] = static_cast<std::uint8_t>(met);
      high[i] = static_cast<std::uint8_t>(met >> 8);
      any |= met;
    }
    for (int half = 0; half < 2; ++half) {
      const std::uint8_t* bytes = half ? high : low;
      __m256i a = _mm256_load_si256(reinterpret_cast<const __m256i*>(bytes));
      __m256i b = _mm256_load_si256(reinterpret_cast<const __m256i*>(bytes + 32));
      for (int bit = 7; bit >= 0; --bit) {
        meeting[static_cast<std::size_t>(half * 8 + bit)] =
            static_cast<std::uint32_t>(_mm256_movemask_epi8(a)) |
            RaySet{static_cast<std::uint32_t>(_mm256_movemask_epi8(b))} << 32;
        a = _mm256_add_epi8(a, a);
        b = _mm256_add_epi8(b, b);
      }
    }
    return any;
  }

  // Keeps the entries from `base` on sorted, the nearest on top.
  void push(std::size_t base, const Entry& entry) {
    std::size_t slot = size_++;
    for (; slot > base && stack_[slot - 1].t_near < entry.t_near; --slot) stack_[slot] = stack_[slot - 1];
    stack_[slot] = entry;
  }

  template <Query kQuery>
  void go_alone(std::size_t i, BvhChild child) {
    enqueue_pending(i);
    settle<kQuery>();
    hits_[i] = RayTraversal(scene_.primitives, ray(i), group_.slab_ray(i), sheared_[i], hits_[i])
                   .template run<kQuery>(scene_.nodes, scene_.packets, child);
    update<kQuery>(i);
  }

  // After hits_[i] may have changed.
  template <Query kQuery>
  void update(std::size_t i) {
    if (kQuery == Query::kAny) {
      if (hits_[i].found()) alive_ &= ~(RaySet{1} << i);
      return;
    }
    t_low_[i] = t_high_[i] = std::min(hits_[i].t, ray(i).t_max);
    group_.set_limit(i, box_limit(t_high_[i]));
  }

  template <Query kQuery>
  void visit(std::uint32_t index, RaySet set, int count) {
    const BvhPacket& packet = scene_.packets[index];
    int vectors = 0;
    for (std::size_t v = 0; v < RayGroup::kVectors; ++v) vectors += RayGroup::lanes(set, v) != 0;
    if (!group_.can_filter() || packet.sphere_lanes != 0 ||
        std::popcount(packet.triangle_lanes) * vectors * kTriangleVsVector > count * kRayVsPacket) {
      for (RaySet s = set; s != 0; s &= s - 1)
        visit_alone<kQuery>(static_cast<std::size_t>(std::countr_zero(s)), packet);
      return;
    }
    for (std::size_t v = 0; v < RayGroup::kVectors; ++v)
      if (RayGroup::lanes(set, v) != 0) test<kQuery>(packet, index, v, RayGroup::lanes(set, v));
    if (queued_ != 0) settle<kQuery>();
  }

  template <Query kQuery>
  void visit_alone(std::size_t i, const BvhPacket& packet) {
    const TriangleHits hits = hits_of_packet(sheared_[i], packet);
    unsigned lanes = hits.lanes() & packet.triangle_lanes;
    if ((lanes | packet.sphere_lanes) == 0) return;
    if (has_pending(i)) {
      enqueue_pending(i);
      settle<kQuery>();
    }
    for (; lanes != 0; lanes &= lanes - 1) {
      const int lane = std::countr_zero(lanes);
      const float t = hits.t(lane);
      if (t <= hits_[i].t)
        hits_[i].improve(ray(i), {t, packet.primitives[lane], hits.b1(lane), hits.b2(lane)});
    }
    for (unsigned s = packet.sphere_lanes; s != 0; s &= s - 1) {
      scene_.primitives.intersect(packet.primitives[std::countr_zero(s)], ray(i), hits_[i]);
    }
    update<kQuery>(i);
  }

  // The rays of a vector against a packet's triangles. Without branches but for what is not sure: how many
  // rays hit a triangle cannot be guessed.
  template <Query kQuery>
  void test(const BvhPacket& packet, std::uint32_t index, std::size_t v, unsigned lanes) {
    const FilterRays rays = group_.filter_rays(v);
    const int* axes = group_.filter_axes();
    float* const t_low = t_low_ + kLanes * v;
    float* const t_high = t_high_ + kLanes * v;
    float* const pending = pending_ + kLanes * v;
    const Mask8 asked = Mask8::from_bits(lanes);
    for (unsigned triangles = packet.triangle_lanes; triangles != 0; triangles &= triangles - 1) {
      const int lane = std::countr_zero(triangles);
      const std::uint32_t triangle = index * BvhPacket::kWidth + static_cast<std::uint32_t>(lane);
      const TriangleFilter filter(
          rays, [&](int corner, int axis) { return Float8(packet.corners[corner][axes[axis]][lane]); });
      const Mask8 may_hit = asked & !filter.surely_outside();
      const Mask8 inside = filter.surely_inside();
      const auto [low, high] = filter.t(rays);
      const Float8 old_low = Float8::load(t_low), old_high = Float8::load(t_high);
      const Mask8 worse = inside & ((high < Float8(0)) | (old_high < low));
      const Mask8 sure = asked & inside & (Float8(0) < low) & (high < old_low);
      const unsigned unsure = (may_hit & !worse & !sure).bits();
      if (kQuery == Query::kAny) {
        alive_ &= ~(RaySet{sure.bits()} << (kLanes * v));
      } else {
        select(sure, low, old_low).store(t_low);
        select(sure, high, old_high).store(t_high);
        select(sure, Float8(std::bit_cast<float>(triangle)), Float8::load(pending)).store(pending);
      }
      for (unsigned s = unsure; s != 0; s &= s - 1) {
        const std::size_t i = kLanes * v + static_cast<std::size_t>(std::countr_zero(s));
        enqueue_pending(i);
        queue_[queued_++] = {static_cast<std::uint32_t>(i), triangle};
      }
    }
    if (kQuery == Query::kClosest) group_.set_limits(v, Float8::load(t_high));
  }

  bool has_pending(std::size_t i) const { return std::bit_cast<std::uint32_t>(pending_[i]) != kNothing; }

  void enqueue_pending(std::size_t i) {
    if (!has_pending(i)) return;
    queue_[queued_++] = {static_cast<std::uint32_t>(i), std::bit_cast<std::uint32_t>(pending_[i])};
    pending_[i] = std::bit_cast<float>(kNothing);
  }

  template <Query kQuery>
  void settle() {
    for (std::size_t begin = 0, count; begin < queued_; begin += count) {
      count = std::min<std::size_t>(4, queued_ - begin);  // the queue may grow
      std::array<const ShearedRay*, 4> rays;
      std::array<const BvhPacket*, 4> packets;
      std::array<std::uint32_t, 4> lane;
      for (std::size_t k = 0; k < 4; ++k) {
        const Pair& pair = queue_[begin + std::min(k, count - 1)];
        rays[k] = &sheared_[pair.ray];
        packets[k] = &scene_.packets[pair.triangle / BvhPacket::kWidth];
        lane[k] = pair.triangle % BvhPacket::kWidth;
      }
      const TriangleHits hits(ShearedRays(rays), [&](int corner, int axis) {
        const auto at = [&](std::size_t k) {
          return packets[k]->corners[corner][rays[k]->axis(axis)][lane[k]];
        };
        return Double4::of(at(0), at(1), at(2), at(3));
      });
      alignas(16) float t[4], b1[4], b2[4];
      if (hits.lanes() != 0) hits.store(t, b1, b2);
      for (std::size_t k = 0; k < count; ++k) {
        const std::size_t i = queue_[begin + k].ray;
        if (hits.lanes() >> k & 1)
          hits_[i].improve(ray(i), {t[k], packets[k]->primitives[lane[k]], b1[k], b2[k]});
        update<kQuery>(i);
        enqueue_pending(i);
      }
    }
    queued_ = 0;
  }

  struct Pair {
    std::uint32_t ray, triangle;
  };

  const GroupScene& scene_;
  std::span<const Ray> rays_;
  std::span<const std::uint32_t> order_;
  RayGroup group_;
  RaySet alive_;
  alignas(32) float t_low_[kSize];
  alignas(32) float t_high_[kSize];
  alignas(32) float pending_[kSize];
  std::array<Hit, kSize> hits_;
  std::array<ShearedRay, kSize> sheared_;
  std::array<Pair, 3 * kSize * BvhPacket::kWidth> queue_;
  std::size_t queued_ = 0;
  std::size_t size_ = 0;
  Entry stack_[1 + (BvhNode::kWidth - 1) * (kMaxBinaryDepth + 1)];
};

}  // namespace

void trace_closest(const GroupScene& scene, std::span<const Ray> rays, std::span<const std::uint32_t> order,
                   std::span<Hit> hits) {
  GroupTraversal traversal(scene, rays, order);
  traversal.run<Query::kClosest>();
  for (std::size_t i = 0; i < order.size(); ++i) hits[order[i]] = traversal.hit(i);
}

void trace_any(const GroupScene& scene, std::span<const Ray> rays, std::span<const std::uint32_t> order,
               std::span<std::uint8_t> occluded) {
  GroupTraversal traversal(scene, rays, order);
  traversal.run<Query::kAny>();
  for (std::size_t i = 0; i < order.size(); ++i) occluded[order[i]] = traversal.occluded(i) ? 1 : 0;
}

}  // namespace tessera::core
