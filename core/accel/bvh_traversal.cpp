// Bvh's queries.
#include <array>

#include "core/accel/bvh.hpp"
#include "core/accel/group_traversal.hpp"
#include "core/accel/ray_traversal.hpp"

namespace tessera::core {
namespace {

// Rays are sorted by octant within runs of this many.
constexpr std::size_t kRun = 512;

// The rays of a run, those of the same octant together and otherwise as they come.
class OctantOrder {
 public:
  OctantOrder(std::span<const Ray> rays, std::size_t begin, std::size_t end) {
    std::array<std::uint8_t, kRun> octants;
    unsigned every = 7, some = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const unsigned into = octant(rays[i]);
      octants[i - begin] = static_cast<std::uint8_t>(into);
      every &= into, some |= into;
    }
    if (every == some) {
      for (std::size_t i = begin; i < end; ++i) order_[i - begin] = static_cast<std::uint32_t>(i);
      std::fill(first_.begin() + some + 1, first_.end(), end - begin);
      return;
    }
    for (std::size_t i = 0; i < end - begin; ++i) ++first_[octants[i] + 1u];
    for (std::size_t o = 1; o <= kOctants; ++o) first_[o] += first_[o - 1];
    auto next = first_;
    for (std::size_t i = begin; i < end; ++i)
      order_[next[octants[i - begin]]++] = static_cast<std::uint32_t>(i);
  }

  static constexpr std::size_t kOctants = 8;
  std::span<const std::uint32_t> rays(std::size_t octant) const {
    return std::span(order_).subspan(first_[octant], first_[octant + 1] - first_[octant]);
  }

 private:
  std::array<std::uint32_t, kRun> order_;
  std::array<std::size_t, kOctants + 1> first_{};
};

// What it takes to prepare a group is not worth it for fewer.
constexpr std::size_t kLeastGroup = 8;

// Calls together(order) for groups of rays of one octant each, alone(i) for each of those that are too few.
template <typename Together, typename Alone>
void for_each_group(std::span<const Ray> rays, const Together& together, const Alone& alone) {
  for (std::size_t begin = 0; begin < rays.size(); begin += kRun) {
    const OctantOrder order(rays, begin, std::min(begin + kRun, rays.size()));
    for (std::size_t octant = 0; octant < OctantOrder::kOctants; ++octant) {
      for (auto left = order.rays(octant); !left.empty();) {
        const auto group = left.first(std::min(kGroupSize, left.size()));
        left = left.subspan(group.size());
        if (group.size() >= kLeastGroup) {
          together(group);
        } else {
          for (const std::uint32_t i : group) alone(i);
        }
      }
    }
  }
}

class CountedVisits {
 public:
  explicit CountedVisits(VisitCounts& counts) : counts_(counts) {}
  void node() const { ++counts_.nodes; }
  void packet() const { ++counts_.packets; }

 private:
  VisitCounts& counts_;
};

}  // namespace

Hit Bvh::closest_hit(const Primitives& primitives, const Ray& ray) const {
  if (arrays_.nodes.empty()) return {};
  return RayTraversal(primitives, arrays_.objects.data(), ray)
      .run<Query::kClosest>(arrays_.nodes.data(), arrays_.packets.data());
}

bool Bvh::any_hit(const Primitives& primitives, const Ray& ray) const {
  if (arrays_.nodes.empty()) return false;
  return RayTraversal(primitives, arrays_.objects.data(), ray)
      .run<Query::kAny>(arrays_.nodes.data(), arrays_.packets.data())
      .found();
}

VisitCounts Bvh::count_visits(const Primitives& primitives, std::span<const Ray> rays) const {
  VisitCounts counts;
  if (arrays_.nodes.empty()) return counts;
  for (const Ray& ray : rays) {
    RayTraversal(primitives, arrays_.objects.data(), ray)
        .run<Query::kClosest>(arrays_.nodes.data(), arrays_.packets.data(), CountedVisits(counts));
  }
  return counts;
}

void Bvh::closest_hits(const Primitives& primitives, std::span<const Ray> rays, std::span<Hit> hits) const {
  if (arrays_.nodes.empty()) {
    std::fill(hits.begin(), hits.end(), Hit{});
    return;
  }
  const GroupScene scene{primitives, arrays_.objects.data(), arrays_.nodes.data(), arrays_.packets.data()};
  for_each_group(
      rays, [&](std::span<const std::uint32_t> order) { trace_closest(scene, rays, order, hits); },
      [&](std::uint32_t i) { hits[i] = closest_hit(primitives, rays[i]); });
}

void Bvh::any_hits(const Primitives& primitives, std::span<const Ray> rays,
                   std::span<std::uint8_t> occluded) const {
  if (arrays_.nodes.empty()) {
    std::fill(occluded.begin(), occluded.end(), std::uint8_t{0});
    return;
  }
  const GroupScene scene{primitives, arrays_.objects.data(), arrays_.nodes.data(), arrays_.packets.data()};
  for_each_group(
      rays, [&](std::span<const std::uint32_t> order) { trace_any(scene, rays, order, occluded); },
      [&](std::uint32_t i) { occluded[i] = any_hit(primitives, rays[i]) ? 1 : 0; });
}

}  // namespace tessera::core
