// SPDX-License-Identifier: Apache-2.0
// The queries of Bvh.
#include "core/accel/bvh.hpp"

#include <algorithm>

#include "core/accel/group_traversal.hpp"
#include "core/accel/octant_groups.hpp"
#include "core/accel/ray_traversal.hpp"

namespace tessera::core::accel {
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

Hit Bvh::closest_hit(const Primitives& primitives, const Ray& ray, const HitOpacity* opacity) const {
  if (arrays_.nodes.empty()) return {};
  Hit hit = RayTraversal(primitives, arrays_.objects.data(), OpacityOf(opacity, primitives.has_motion()), ray)
                .run<Query::kClosest>(arrays_.nodes.data(), arrays_.packets.data());
  if (primitives.has_motion()) hit.time = ray.time;
  return hit;
}

Occlusion Bvh::occlusion(const Primitives& primitives, const Ray& ray, const HitOpacity* opacity) const {
  if (arrays_.nodes.empty()) return Occlusion::kNone;
  RayTraversal traversal(primitives, arrays_.objects.data(), OpacityOf(opacity, primitives.has_motion()),
                         ray);
  if (traversal.run<Query::kAny>(arrays_.nodes.data(), arrays_.packets.data()).found())
    return Occlusion::kFull;
  return traversal.is_partly_occluded() ? Occlusion::kPartial : Occlusion::kNone;
}

VisitCounts Bvh::count_visits(const Primitives& primitives, std::span<const Ray> rays) const {
  VisitCounts counts;
  if (arrays_.nodes.empty()) return counts;
  for (const Ray& ray : rays) {
    RayTraversal(primitives, arrays_.objects.data(), OpacityOf(), ray)
        .run<Query::kClosest>(arrays_.nodes.data(), arrays_.packets.data(), CountedVisits(counts));
  }
  return counts;
}

void Bvh::closest_hits(const Primitives& primitives, ColumnsView<const Ray> rays, ColumnsView<Hit> hits,
                       const HitOpacity* opacity) const {
  if (arrays_.nodes.empty()) {
    for (std::size_t i = 0; i < rays.size(); ++i) hits.set(i, {});
    return;
  }
  const GroupScene scene{primitives, arrays_.objects.data(), arrays_.nodes.data(), arrays_.packets.data(),
                         OpacityOf(opacity, primitives.has_motion())};
  for_each_run(rays, [&](std::size_t first, std::size_t count) {
    const ColumnsView<const Ray> run = rays.rows(first, count);
    const ColumnsView<Hit> of_run = hits.rows(first, count);
    for_each_group(
        run, [&](std::span<const std::uint16_t> order) { trace_closest(scene, run, order, of_run); },
        [&](std::size_t i) { of_run.set(i, closest_hit(primitives, run[i], opacity)); });
  });
  if (!primitives.has_motion()) return;
  const ColumnsView<const float> times = rays.field(&Ray::time);
  std::copy_n(times.column(0), times.size(), hits.field(&Hit::time).column(0));
}

void Bvh::occlusions(const Primitives& primitives, ColumnsView<const Ray> rays, std::span<Occlusion> occluded,
                     const HitOpacity* opacity) const {
  if (arrays_.nodes.empty()) {
    std::fill(occluded.begin(), occluded.end(), Occlusion::kNone);
    return;
  }
  const GroupScene scene{primitives, arrays_.objects.data(), arrays_.nodes.data(), arrays_.packets.data(),
                         OpacityOf(opacity, primitives.has_motion())};
  for_each_run(rays, [&](std::size_t first, std::size_t count) {
    const ColumnsView<const Ray> run = rays.rows(first, count);
    const std::span<Occlusion> of_run = occluded.subspan(first, count);
    for_each_group(
        run, [&](std::span<const std::uint16_t> order) { trace_any(scene, run, order, of_run); },
        [&](std::size_t i) { of_run[i] = occlusion(primitives, run[i], opacity); });
  });
}

}  // namespace tessera::core::accel
