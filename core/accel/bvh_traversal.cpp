// SPDX-License-Identifier: Apache-2.0
// The queries of Bvh.
#include "core/accel/bvh.hpp"
#include "core/accel/group_traversal.hpp"
#include "core/accel/octant_groups.hpp"
#include "core/accel/ray_traversal.hpp"

namespace tessera::core {
namespace {

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
  Hit hit = RayTraversal(primitives, arrays_.objects.data(), ray)
                .run<Query::kClosest>(arrays_.nodes.data(), arrays_.packets.data());
  if (primitives.has_motion()) hit.time = ray.time;
  return hit;
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
  for_each_run(rays, hits, [&](std::span<const Ray> run, std::span<Hit> of_run) {
    for_each_group(
        run, [&](std::span<const std::uint16_t> order) { trace_closest(scene, run, order, of_run); },
        [&](std::size_t i) { of_run[i] = closest_hit(primitives, run[i]); });
  });
  if (!primitives.has_motion()) return;
  for (std::size_t i = 0; i < rays.size(); ++i) hits[i].time = rays[i].time;
}

void Bvh::any_hits(const Primitives& primitives, std::span<const Ray> rays,
                   std::span<std::uint8_t> occluded) const {
  if (arrays_.nodes.empty()) {
    std::fill(occluded.begin(), occluded.end(), std::uint8_t{0});
    return;
  }
  const GroupScene scene{primitives, arrays_.objects.data(), arrays_.nodes.data(), arrays_.packets.data()};
  for_each_run(rays, occluded, [&](std::span<const Ray> run, std::span<std::uint8_t> of_run) {
    for_each_group(
        run, [&](std::span<const std::uint16_t> order) { trace_any(scene, run, order, of_run); },
        [&](std::size_t i) { of_run[i] = any_hit(primitives, run[i]) ? 1 : 0; });
  });
}

}  // namespace tessera::core
